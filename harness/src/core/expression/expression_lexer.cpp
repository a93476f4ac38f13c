#include "expression_lexer.h"

#include <fmt/format.h>
#include <rehearse/units.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "expression.h"

namespace rehearse {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
/// A slash may be part of a name: a division needs a blank before it.
bool goes_on_name(char c) {
  return begins_name(c) || is_digit(c) || c == '/' || c == '.' || c == ':' || c == '%' || c == '#';
}

/// Number of characters before that byte; continuation bytes aren't counted.
std::size_t characters_before(std::string_view text, std::size_t at) {
  return static_cast<std::size_t>(std::count_if(text.begin(),
                                                text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size())),
                                                [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

Diagnostic expression_error(std::string_view text, std::size_t at, std::string message, std::string hint) {
  Diagnostic diagnostic = error(std::move(message), std::move(hint));
  diagnostic.line = 1;
  diagnostic.column = static_cast<int>(characters_before(text, at)) + 1;
  return diagnostic;
}

ExpressionToken ExpressionLexer::token(ExpressionToken::Kind kind, std::size_t begin) const {
  ExpressionToken made;
  made.kind = kind;
  made.text = text_.substr(begin, at_ - begin);
  made.begin = begin;
  made.end = at_;
  return made;
}

Result<ExpressionToken> ExpressionLexer::next() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  if (at_ == text_.size()) return token(ExpressionToken::Kind::end, at_);
  const char c = text_[at_];
  const bool point = c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]);
  if (is_digit(c) || point) return number();
  if (c == '\'' || c == '"') return quoted(c);
  if (begins_name(c)) return name();
  return symbol();
}

Result<ExpressionToken> ExpressionLexer::number() {
  const std::size_t begin = at_;
  double value = 0.0;
  const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
  at_ = static_cast<std::size_t>(read.ptr - text_.data());
  if (read.ec != std::errc()) return expression_error(text_, begin, "this number is beyond the range of a double");
  std::size_t after = at_;
  while (after < text_.size() && is_blank(text_[after])) ++after;
  const std::optional<WrittenUnit> unit = leading_unit(text_.substr(after));
  if (unit) {
    at_ = after + unit->text.size();
  } else if (after == at_ && after < text_.size() && begins_name(text_[after])) {
    std::size_t end = after;
    while (end < text_.size() && (begins_name(text_[end]) || is_digit(text_[end]))) ++end;
    return expression_error(text_, after, fmt::format("'{}' is no unit", text_.substr(after, end - after)),
                            fmt::format("a number may have one of {}; a name that begins with a digit is written in "
                                        "quotes",
                                        known_units()));
  }
  ExpressionToken made = token(ExpressionToken::Kind::number, begin);
  made.number = unit ? value * unit->scale : value;
  made.unit = unit ? unit->unit : "";
  made.degrees = unit && unit->text.starts_with("deg");
  return made;
}

/// A quote within is doubled.
Result<ExpressionToken> ExpressionLexer::quoted(char quote) {
  const std::size_t begin = at_;
  std::string text;
  for (std::size_t from = begin + 1;;) {
    const std::size_t end = text_.find(quote, from);
    if (end == std::string_view::npos) return expression_error(text_, begin, "this quote isn't closed");
    text += text_.substr(from, end - from);
    at_ = end + 1;
    if (at_ == text_.size() || text_[at_] != quote) break;
    text += quote;
    from = at_ + 1;
  }
  ExpressionToken made = token(ExpressionToken::Kind::quoted, begin);
  made.text = std::move(text);
  return made;
}

ExpressionToken ExpressionLexer::name() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && goes_on_name(text_[at_])) ++at_;
  return token(ExpressionToken::Kind::name, begin);
}

Result<ExpressionToken> ExpressionLexer::symbol() {
  const std::size_t begin = at_;
  for (const std::string_view symbol :
       {"&&", "||", "==", "!=", "<=", ">=", "<", ">", "!", "+", "-", "*", "/", "(", ")", ","}) {
    if (!text_.substr(at_).starts_with(symbol)) continue;
    at_ += symbol.size();
    return token(ExpressionToken::Kind::symbol, begin);
  }
  const char c = text_[begin];
  const std::string hint = c == '='   ? "equality is written =="
                           : c == '&' ? "and is written &&"
                           : c == '|' ? "or is written ||"
                                      : "a name with other characters is written in quotes";
  const bool prints = c > ' ' && c < 0x7f;
  return expression_error(text_, begin,
                          prints ? fmt::format("'{}' has no meaning here", c)
                                 : fmt::format("the byte {:#04x} has no meaning here", static_cast<unsigned char>(c)),
                          hint);
}

std::string caret_lines(std::string_view text, int column) {
  std::string shown;
  for (const char c : text) shown += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  const std::size_t before = column > 0 ? static_cast<std::size_t>(column) - 1 : 0;
  return fmt::format("  {}\n  {}^", shown, std::string(before, ' '));
}

std::string with_caret(const Diagnostic& diagnostic, std::string_view text) {
  Diagnostic without_place = diagnostic;
  without_place.line = without_place.column = 0;
  return fmt::format("{}\n{}\n", to_string(without_place), caret_lines(text, diagnostic.column));
}

}  // namespace rehearse
