// Splits an expression into tokens. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace rehearse {

struct ExpressionToken {
  enum class Kind { end, number, name, quoted, symbol };
  Kind kind = Kind::end;
  std::string text = {};           // a name without its quotes; a symbol: "&&"
  double number = 0.0;             // in `unit`
  std::string unit = {};           // of a number, as recordings have it: "rad"; empty: none was written
  bool degrees = false;            // of a number: it was written in degrees
  std::size_t begin = 0, end = 0;  // in the expression [bytes]
};

/// An error at a byte offset of the expression.
Diagnostic expression_error(std::string_view text, std::size_t at, std::string message, std::string hint = {});

class ExpressionLexer {
 public:
  /// The text must outlive it.
  explicit ExpressionLexer(std::string_view text) : text_(text) {}
  Result<ExpressionToken> next();

 private:
  Result<ExpressionToken> number();
  Result<ExpressionToken> quoted(char quote);
  ExpressionToken name();
  Result<ExpressionToken> symbol();
  ExpressionToken token(ExpressionToken::Kind kind, std::size_t begin) const;

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace rehearse
