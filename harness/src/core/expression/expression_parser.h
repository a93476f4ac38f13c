// Parses tokens into an Expression, by recursive descent; it also checks types and units. Internal. Calls of functions
// are parsed in expression_calls.cpp.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>

#include "expression.h"
#include "expression_lexer.h"

namespace rehearse {

enum class Expression::Op : std::uint8_t {
  number,
  tick,
  time,
  differs,
  series,
  contact,
  message,
  event,
  negate,
  logical_not,
  add,
  subtract,
  multiply,
  divide,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  unequal,
  logical_and,
  logical_or,
  absolute,
  least,
  most,
  square_root,
  sine,
  cosine,
  is_nan,
  previous,
  delta,
  changed,
  step,
  value_at,
  roll,
  pitch,
  yaw,
  lasting,
};

/// Counts the nesting depth of parts during its lifetime.
class Deeper {
 public:
  explicit Deeper(int& depth, int by = 1) : depth_(depth), by_(by) { depth_ += by_; }
  ~Deeper() { depth_ -= by_; }
  Deeper(const Deeper&) = delete;
  Deeper& operator=(const Deeper&) = delete;

 private:
  int& depth_;
  const int by_;
};

class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, ExpressionSource& source) : lexer_(text), source_(source) {
    expression_.text_ = text;
  }
  Result<Expression> parse();

 private:
  using Node = Expression::Node;
  using Op = Expression::Op;
  using Type = Expression::Type;
  /// The index of a node; nullopt: failed_ has the reason.
  using Made = std::optional<std::size_t>;
  /// Parses one kind of part.
  using Rule = Made (ExpressionParser::*)();
  struct Operator {
    std::string_view symbol;
    Op op;
  };

  bool advance();
  Made fail(std::size_t at, std::string message, std::string hint = {});
  bool is_symbol(std::string_view symbol) const;
  bool expect(std::string_view symbol, std::string_view where);
  bool demand(std::size_t node, Type type, std::string_view who);
  /// False if the numbers have different units.
  bool have_common_unit(std::size_t left, std::size_t right, std::string_view who);
  /// Reports a `for` in an operand.
  bool demand_instant(std::size_t node, std::string_view who);
  std::optional<double> duration(std::string_view where);
  /// Sets unit and variation of an operation from those of its operands.
  Made finished(std::size_t node);
  std::size_t add(Op op, Type type, std::size_t begin, std::size_t end, std::size_t left = 0, std::size_t right = 0);

  /// The operator at the current token; null: none of these is there.
  const Operator* operator_here(std::span<const Operator> operators) const;
  /// Parses operands of a type with operators of one rank between them, which are evaluated from left to right.
  Made chain(Rule operand, std::initializer_list<Operator> operators, Type type);
  Made any_of() { return chain(&ExpressionParser::all_of, {{"||", Op::logical_or}}, Type::boolean); }
  Made all_of() { return chain(&ExpressionParser::comparison, {{"&&", Op::logical_and}}, Type::boolean); }
  /// A comparison, or a condition, and how long it must last.
  Made comparison();
  Made single_comparison();
  Made sum() { return chain(&ExpressionParser::product, {{"+", Op::add}, {"-", Op::subtract}}, Type::number); }
  Made product() { return chain(&ExpressionParser::unary, {{"*", Op::multiply}, {"/", Op::divide}}, Type::number); }
  Made unary();
  Made primary();
  Made name(const ExpressionToken& word);
  struct Function;
  static const std::vector<Function>& functions();
  Made call(const ExpressionToken& word);
  Made arithmetic_call(const ExpressionToken& word, Op op, std::size_t arguments);
  Made shift_call(const ExpressionToken& word, Op op);
  Made side_call(const ExpressionToken& word, CommandSide side);
  Made contact_call(const ExpressionToken& word);
  Made message_call(const ExpressionToken& word, Op op);
  Made joint_call(const ExpressionToken& word);
  Made limit_call(const ExpressionToken& word);
  Made step_call(const ExpressionToken& word);
  Made value_at_call(const ExpressionToken& word);
  /// The name as a token, which is passed; null: `says` was reported.
  std::optional<ExpressionToken> name_argument(std::string says);
  /// X of LINK/x for LINK/position/x, and an angle of LINK/roll, pitch or yaw; null: the name isn't of such a form, or
  /// there is no such link.
  Made derived_series(const ExpressionToken& word);
  Made series(const ExpressionToken& word);
  std::optional<std::vector<std::size_t>> links();

  ExpressionLexer lexer_;
  ExpressionSource& source_;
  Expression expression_;
  ExpressionToken token_;
  std::size_t last_end_ = 0;  // of the token before
  int depth_ = 0;
  int shifts_ = 0;
  std::optional<Diagnostic> failed_;
};

}  // namespace rehearse
