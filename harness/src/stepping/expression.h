// Expression: a question about the ticks of a recording, as one writes it at a terminal.
//
//   SR1/RLEG_KNEE/u > 100 && contact(LEFT_FOOT)
//   abs(delta(output/RLEG_KNEE/u)) > 5 || message("*slip*")
//
// An expression is read once, against the names of a recording, and then evaluated for any tick. It has a type, and
// each of its parts has one; what doesn't fit is found when it is read, with the place. tools/README.md has the
// language.
//
// Numbers are doubles. A comparison with NaN is false, but for !=. What looks at the tick before (prev, delta, changed)
// finds NaN and false before the first one.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// Which of both a command's value is.
enum class CommandSide {
  recorded,
  replayed,  // what the controllers command now, fed with the recorded inputs
};

/// What an expression is about: its names, and the values that they have at a tick. Ids are the source's own.
class ExpressionSource {
 public:
  virtual ~ExpressionSource() = default;

  /// By its name, or by an ending of it that no other has. The error says what is near, or which ones it may be.
  virtual Result<std::size_t> find_series(std::string_view name) = 0;
  /// The series is commanded by a controller, and that controller was replayed.
  virtual bool is_replayed(std::size_t series) const = 0;
  /// Links as BODY/LINK or an ending of it that no other has; of a body's name all its links.
  virtual Result<std::vector<std::size_t>> find_links(std::string_view name) = 0;

  virtual std::int64_t first_tick() const = 0;
  virtual double time_at(std::int64_t tick) const = 0;  // [s]
  /// The latest value at or before that tick; NaN if there is none.
  virtual double value(std::size_t series, std::int64_t tick, CommandSide side) = 0;
  /// Whether any of `links` touches any of `others`, or anything if that is empty.
  virtual bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                        std::int64_t tick) = 0;
  /// The controllers gave something else in that tick than in the recording.
  virtual bool differs_at(std::int64_t tick) = 0;
  /// Whether anything that was said in the tick matches the pattern (glob.h).
  virtual bool said(std::string_view pattern, std::int64_t tick) = 0;
};

class Expression {
 public:
  enum class Type { boolean, number };
  static constexpr std::size_t longest = 4096;  // [bytes]
  static constexpr int deepest = 100;           // parentheses, signs and functions in each other
  static constexpr int most_shifts = 4;         // prev, delta and changed in each other

  /// Fails with one diagnostic whose column is the place in the text [characters]; see with_caret().
  static Result<Expression> parse(std::string_view text, ExpressionSource& source);

  /// boolean or number.
  Type type() const { return nodes_[root_].type; }
  const std::string& text() const { return text_; }
  /// Of a boolean one.
  bool holds(ExpressionSource& source, std::int64_t tick) const;
  /// Of either; a boolean is 0 or 1.
  double number(ExpressionSource& source, std::int64_t tick) const;

  /// A part that is looked up and not computed: a series, a contact, a message, recorded(x) or replayed(x).
  struct Operand {
    std::string text;  // as it was written
    std::size_t node = 0;
  };
  /// In the order of the text, each once; tick, time and differs aren't among them.
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
    std::size_t left = 0, right = 0;  // indices of nodes; always before this one
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
