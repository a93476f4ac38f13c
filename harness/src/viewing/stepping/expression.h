// Expression: a condition or a number for the ticks of a recording, as a user types it in a terminal.
//
//   SR1/RLEG_KNEE/u > 100 && contact(LEFT_FOOT)
//   abs(delta(output/RLEG_KNEE/u)) > 5 || message("*slip*")
//
// An expression is parsed once, with the names of a recording, and then evaluated for any tick. It has a type, and each
// of its parts has one; parsing reports type errors with their place. The page reference/expressions.md describes the language.
//
// Numbers are doubles. A comparison with NaN is false, except !=. Functions of the tick before (prev, delta, changed)
// return NaN and false in the first tick.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The recorded or the replayed value of a command.
enum class CommandSide {
  recorded,
  replayed,  // the present commands of the controllers for the recorded inputs
};

/// The source of an expression's data: names, and their values at a tick. The source defines the ids.
class ExpressionSource {
 public:
  virtual ~ExpressionSource() = default;

  /// Finds a series by its name, or by an unambiguous ending of it. The error lists similar names, or the ambiguous
  /// ones.
  virtual Result<std::size_t> find_series(std::string_view name) = 0;
  /// True if a controller commands the series, and that controller was replayed.
  virtual bool is_replayed(std::size_t series) const = 0;
  /// Finds links by BODY/LINK or an unambiguous ending of it; for the name of a body it returns all its links.
  virtual Result<std::vector<std::size_t>> find_links(std::string_view name) = 0;

  virtual std::int64_t first_tick() const = 0;
  virtual double time_at(std::int64_t tick) const = 0;  // [s]
  /// The latest value up to that tick; NaN if there is none.
  virtual double value(std::size_t series, std::int64_t tick, CommandSide side) = 0;
  /// True if any of `links` touches any of `others`, or any object if `others` is empty.
  virtual bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                        std::int64_t tick) = 0;
  /// True if outputs of the controllers in that tick differ from the recording.
  virtual bool differs_at(std::int64_t tick) = 0;
  /// True if any message of the tick matches the pattern (glob.h).
  virtual bool said(std::string_view pattern, std::int64_t tick) = 0;
};

class Expression {
 public:
  enum class Type { boolean, number };
  static constexpr std::size_t longest = 4096;  // [bytes]
  static constexpr int deepest = 100;           // nesting depth of parentheses, signs and functions
  static constexpr int most_shifts = 4;         // nesting depth of prev, delta and changed

  /// Fails with one diagnostic whose column is the place in the text [characters]; see with_caret().
  static Result<Expression> parse(std::string_view text, ExpressionSource& source);

  /// boolean or number.
  Type type() const { return nodes_[root_].type; }
  const std::string& text() const { return text_; }
  /// The value of a boolean expression.
  bool holds(ExpressionSource& source, std::int64_t tick) const;
  /// The value of any expression; a boolean is 0 or 1.
  double number(ExpressionSource& source, std::int64_t tick) const;

  /// A part that is looked up and not computed: a series, a contact, a message, recorded(x) or replayed(x).
  struct Operand {
    std::string text;  // as written in the expression
    std::size_t node = 0;
  };
  /// The operands in the order of the text, each once; without tick, time and differs.
  std::vector<Operand> operands() const;
  double number_of(const Operand& operand, ExpressionSource& source, std::int64_t tick) const;

 private:
  friend class ExpressionParser;
  enum class Op : std::uint8_t;
  struct Node {
    Op op{};
    Type type = Type::number;
    double number = 0.0;
    std::size_t series = 0;
    CommandSide side = CommandSide::recorded;
    std::size_t left = 0, right = 0;  // indices of nodes; always smaller than this node's index
    std::vector<std::size_t> links, others;
    std::string pattern;
    std::size_t begin = 0, end = 0;  // in the text [bytes]
  };
  double evaluate(std::size_t node, ExpressionSource& source, std::int64_t tick) const;
  bool differs_from_before(std::size_t node, ExpressionSource& source, std::int64_t tick) const;

  std::string text_;
  std::vector<Node> nodes_;
  std::size_t root_ = 0;
};

/// The diagnostic as a line, then the text, and a caret under the place.
std::string with_caret(const Diagnostic& diagnostic, std::string_view text);

}  // namespace rehearse
