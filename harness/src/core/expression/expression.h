// Expression: a condition or a number for the ticks of a recording, as a user types it in a terminal or in a scenario.
//
//   SR1/RLEG_KNEE/u > 100 && contact(LEFT_FOOT)
//   abs(SR1/WAIST/pitch) < 8 deg
//   SR1/RLEG_KNEE/u > 0.95 * limit(SR1/RLEG_KNEE, effort) for 0.2 s
//
// An expression is parsed once, with the names of a recording, and then evaluated for any tick. It has a type, and each
// of its parts has one, and numbers have units; parsing reports mistakes in both with their place. The page
// reference/expressions.md describes the language; formula.h judges whole runs by expressions.
//
// Numbers are doubles. A comparison with NaN is false, except !=. Functions of the tick before (prev, delta, changed,
// step) return NaN and false in the first tick. Judged over time, a condition is unknown before the first samples of
// its series, and in the first tick if it reads the tick before.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "judgement.h"

namespace rehearse {

/// The recorded or the replayed value of a command.
enum class CommandSide {
  recorded,
  replayed,  // the present commands of the controllers for the recorded inputs
};

struct JointLimit {
  double value = 0.0;
  std::string unit;  // as recordings have it: "N·m"
};

/// The source of an expression's data: names, and their values at a tick. The source defines the ids.
class ExpressionSource {
 public:
  virtual ~ExpressionSource() = default;

  /// Finds a series by its name, or by an unambiguous ending of it. The error lists similar names, or the ambiguous
  /// ones.
  virtual Result<std::size_t> find_series(std::string_view name) = 0;
  /// True if a controller commands the series, and that controller was replayed.
  virtual bool is_replayed(std::size_t) const { return false; }
  /// Finds links by BODY/LINK or an unambiguous ending of it; for the name of a body it returns all its links.
  virtual Result<std::vector<std::size_t>> find_links(std::string_view name) = 0;

  /// False if no controller is replayed, so that `differs` has no meaning.
  virtual bool has_replay() const { return false; }
  /// The unit of a series as recordings have it: "N·m"; empty: unknown.
  virtual std::string unit_of_series(std::size_t) { return {}; }
  /// The series "q", "dq" or "u" of a joint, given by BODY/JOINT or an unambiguous ending of it: of the joint itself,
  /// or of the command of the body's controller. The error lists the ambiguous ones.
  virtual Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command);
  /// A limit of a joint: "effort", "velocity", "upper" or "lower".
  virtual Result<JointLimit> find_limit(std::string_view joint, std::string_view limit);

  virtual std::int64_t first_tick() const { return 0; }
  /// The last tick that is known; a window that ends after it can't be judged.
  virtual std::int64_t last_tick() const { return std::numeric_limits<std::int64_t>::max(); }
  /// The number that the recording gives to the tick.
  virtual std::int64_t number_of(std::int64_t tick) const { return tick; }
  virtual double time_at(std::int64_t tick) const = 0;  // [s]
  /// Whether a series has had a sample up to a tick.
  enum class Sampled {
    yes,
    no,
    blank,  // it had messages, and NaN in each of them
  };
  virtual Sampled sampled(std::size_t, std::int64_t, CommandSide) const { return Sampled::yes; }
  /// The same of value_at().
  virtual Sampled sampled_at(std::size_t, double, std::int64_t) const { return Sampled::yes; }
  /// The latest value up to that tick; NaN if there is none.
  virtual double value(std::size_t series, std::int64_t tick, CommandSide side) = 0;
  /// True if any of `links` touches any of `others`, or any object if `others` is empty.
  virtual bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                        std::int64_t tick) = 0;
  /// True if outputs of the controllers in that tick differ from the recording.
  virtual bool differs_at(std::int64_t) { return false; }
  /// True if any message of the tick matches the pattern (glob.h).
  virtual bool said(std::string_view, std::int64_t) { return false; }
  /// True if "SEVERITY SOURCE: TEXT" of any message of the tick matches the pattern.
  virtual bool happened(std::string_view, std::int64_t) { return false; }
  /// The latest value up to a time [s], if the tick isn't before it; else NaN.
  virtual double value_at(std::size_t, double, std::int64_t) { return std::numeric_limits<double>::quiet_NaN(); }
};

class Expression {
 public:
  enum class Type { boolean, number };
  static constexpr std::size_t longest = 4096;  // [bytes]
  static constexpr int deepest = 100;           // nesting depth of parentheses, signs and functions
  static constexpr int most_shifts = 4;         // ticks before the present one that prev, delta, changed, step reach

  /// Fails with one diagnostic whose column is the place in the text [characters]; see with_caret().
  static Result<Expression> parse(std::string_view text, ExpressionSource& source);

  /// boolean or number.
  Type type() const { return nodes_[root_].type; }
  const std::string& text() const { return text_; }
  /// The value of a boolean expression.
  bool holds(ExpressionSource& source, std::int64_t tick) const;
  /// The value of any expression; a boolean is 0 or 1.
  double number(ExpressionSource& source, std::int64_t tick) const;
  /// The truth of a condition with its margin. `part`: of a part of it.
  Judged judged(ExpressionSource& source, std::int64_t tick) const { return judge({source, tick, true}, root_); }
  Judged judged(ExpressionSource& source, std::int64_t tick, std::size_t part) const {
    return judge({source, tick, true}, part);
  }

  /// How a condition is made of others, down to those of one tick.
  struct Part {
    enum class Kind { instant, negation, conjunction, disjunction, lasting } kind = Kind::instant;
    std::size_t left = 0, right = 0;  // parts
    double duration = 0.0;            // of lasting [s]
  };
  std::size_t root() const { return root_; }
  Part part(std::size_t index) const;

  /// True if it compares numbers, so that it has a margin.
  bool has_margin() const { return has_margin(root_); }
  /// True if it has a `for`: then it depends on later ticks.
  bool is_temporal() const { return nodes_[root_].is_temporal; }
  /// The unit of the numbers that a comparison compares, and whether one of them is written in degrees.
  const std::string& unit_of(std::size_t comparison) const { return nodes_[comparison].unit; }
  bool is_in_degrees(std::size_t comparison) const { return nodes_[comparison].is_in_degrees; }
  /// The value `x` of the comparison of `value` and `bound` and its bound in words: "6.8 of 8 deg".
  std::string comparison_text(const Judgement& judgement) const;

  /// The series of at(SERIES, TIME), with their times [s].
  struct Moment {
    std::size_t series = 0;
    double time = 0.0;
  };
  std::vector<Moment> moments() const;
  /// The series that it reads, each once, in the order of their ids.
  std::vector<std::size_t> series() const;

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
    std::size_t left = 0, right = 0;         // indices of nodes; always smaller than this node's index
    std::vector<std::size_t> links, others;  // of roll, pitch and yaw: the series x, y, z, w of the orientation
    std::string pattern;
    std::size_t begin = 0, end = 0;  // in the text [bytes]
    std::string unit;                // of a number, or of the numbers of a comparison; empty: it fits all
    bool is_in_degrees = false;      // a number in it is written in degrees
    bool varies = false;             // it isn't the same in all ticks
    bool is_temporal = false;        // it contains `for`
  };
  /// A tick, and whether margins are wanted; without them, && and || stop at the operand that decides.
  struct At {
    ExpressionSource& source;
    std::int64_t tick;
    bool margins = false;
  };
  double evaluate(const At& at, std::size_t node) const;
  double orientation(const At& at, const Node& node) const;
  Judged judge(const At& at, std::size_t node) const;
  Judged compared(const At& at, std::size_t node) const;
  Judged lasting(const At& at, const Node& node) const;
  /// Why a number isn't there: a series of it has no sample so far, or there is no tick before. No cause: it is there.
  Causes absence(const At& at, std::size_t node) const;
  /// The same, if it is there, of the tick before.
  Causes absence_of_change(const At& at, std::size_t node) const;
  bool differs_from_before(const At& at, std::size_t node) const;
  bool jumps(const At& at, const Node& node) const;
  bool has_margin(std::size_t node) const;

  std::string text_;
  std::vector<Node> nodes_;
  std::size_t root_ = 0;
};

/// The diagnostic as a line, then the text, and a caret under the place.
std::string with_caret(const Diagnostic& diagnostic, std::string_view text);
/// Two lines: the text, and a caret under a character of it; column from 1 on.
std::string caret_lines(std::string_view text, int column);

}  // namespace rehearse
