#include "expression_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rehearse {
namespace {

std::string_view word_for(Expression::Type type) {
  constexpr std::array words{"true or false", "a number"};
  return words[static_cast<std::size_t>(type)];
}

constexpr std::string_view functions =
    "abs, min, max, sqrt, sin, cos, nan, prev, delta, changed, recorded, replayed, contact, message";

/// Counts the nesting depth of calls during its lifetime.
class Deeper {
 public:
  explicit Deeper(int& depth) : depth_(depth) { ++depth_; }
  ~Deeper() { --depth_; }
  Deeper(const Deeper&) = delete;
  Deeper& operator=(const Deeper&) = delete;

 private:
  int& depth_;
};

}  // namespace

Result<Expression> Expression::parse(std::string_view text, ExpressionSource& source) {
  if (text.size() > longest)
    return expression_error(text, longest, fmt::format("an expression has at most {} bytes", longest));
  return ExpressionParser(text, source).parse();
}

Result<Expression> ExpressionParser::parse() {
  if (!advance()) return *failed_;
  if (token_.kind == ExpressionToken::Kind::end)
    return expression_error(expression_.text_, 0, "there is nothing in this expression",
                            "expected something like SR1/KNEE/u > 100");
  const Made root = any_of();
  if (!root) return *failed_;
  if (token_.kind != ExpressionToken::Kind::end) {
    const bool closes = is_symbol(")");
    return expression_error(expression_.text_, token_.begin,
                            closes ? "this parenthesis was never opened"
                                   : fmt::format("the expression should end before '{}'", token_.text),
                            closes ? "" : "expected an operator: + - * / < <= > >= == != && ||");
  }
  expression_.root_ = *root;
  return std::move(expression_);
}

bool ExpressionParser::advance() {
  last_end_ = token_.end;
  auto next = lexer_.next();
  if (!next) {
    failed_ = next.errors().front();
    return false;
  }
  token_ = std::move(*next);
  return true;
}

ExpressionParser::Made ExpressionParser::fail(std::size_t at, std::string message, std::string hint) {
  if (!failed_) failed_ = expression_error(expression_.text_, at, std::move(message), std::move(hint));
  return std::nullopt;
}

bool ExpressionParser::is_symbol(std::string_view symbol) const {
  return token_.kind == ExpressionToken::Kind::symbol && token_.text == symbol;
}

bool ExpressionParser::expect(std::string_view symbol, std::string_view where) {
  if (is_symbol(symbol)) return advance();
  fail(token_.begin, fmt::format("expected '{}' {}", symbol, where));
  return false;
}

bool ExpressionParser::demand(std::size_t node, Type type, std::string_view who) {
  const Node& made = expression_.nodes_[node];
  if (made.type == type) return true;
  fail(made.begin, fmt::format("{} takes {}, and this is {}", who, word_for(type), word_for(made.type)),
       type == Type::boolean ? "compare it: x != 0" : "");
  return false;
}

std::size_t ExpressionParser::add(Op op, Type type, std::size_t begin, std::size_t end, std::size_t left,
                                  std::size_t right) {
  Node node;
  node.op = op;
  node.type = type;
  node.left = left;
  node.right = right;
  node.begin = begin;
  node.end = end;
  expression_.nodes_.push_back(std::move(node));
  return expression_.nodes_.size() - 1;
}

const ExpressionParser::Operator* ExpressionParser::operator_here(std::span<const Operator> operators) const {
  const auto found =
      std::find_if(operators.begin(), operators.end(), [this](const Operator& o) { return is_symbol(o.symbol); });
  return found == operators.end() ? nullptr : &*found;
}

ExpressionParser::Made ExpressionParser::chain(Rule operand, std::initializer_list<Operator> operators, Type type) {
  Made left = (this->*operand)();
  while (const Operator* here = left ? operator_here(operators) : nullptr) {
    if (!demand(*left, type, here->symbol) || !advance()) return std::nullopt;
    const Made right = (this->*operand)();
    if (!right || !demand(*right, type, here->symbol)) return std::nullopt;
    left = add(here->op, type, expression_.nodes_[*left].begin, last_end_, *left, *right);
  }
  return left;
}

ExpressionParser::Made ExpressionParser::comparison() {
  static constexpr Operator operators[] = {{"<", Op::less},           {"<=", Op::less_equal}, {">", Op::greater},
                                           {">=", Op::greater_equal}, {"==", Op::equal},      {"!=", Op::unequal}};
  const Made left = sum();
  const Operator* here = left ? operator_here(operators) : nullptr;
  if (!here) return left;
  const bool orders = here->op != Op::equal && here->op != Op::unequal;
  if (orders && !demand(*left, Type::number, here->symbol)) return std::nullopt;
  if (!advance()) return std::nullopt;
  const Made right = sum();
  if (!right || !demand(*right, expression_.nodes_[*left].type, here->symbol)) return std::nullopt;
  if (operator_here(operators))
    return fail(token_.begin, "comparisons can't be chained", "write a < b && b < c, or put one in parentheses");
  return add(here->op, Type::boolean, expression_.nodes_[*left].begin, last_end_, *left, *right);
}

ExpressionParser::Made ExpressionParser::unary() {
  const Deeper deeper(depth_);
  if (depth_ > Expression::deepest)
    return fail(token_.begin, fmt::format("this is more than {} deep", Expression::deepest));
  if (is_symbol("-") || is_symbol("!")) {
    const bool negates = token_.text == "-";
    const std::size_t begin = token_.begin;
    if (!advance()) return std::nullopt;
    const Made of = unary();
    if (!of || !demand(*of, negates ? Type::number : Type::boolean, negates ? "-" : "!")) return std::nullopt;
    return add(negates ? Op::negate : Op::logical_not, negates ? Type::number : Type::boolean, begin, last_end_, *of);
  }
  return primary();
}

ExpressionParser::Made ExpressionParser::primary() {
  const ExpressionToken word = token_;
  switch (word.kind) {
    case ExpressionToken::Kind::number: {
      if (!advance()) return std::nullopt;
      const std::size_t made = add(Op::number, Type::number, word.begin, word.end);
      expression_.nodes_[made].number = word.number;
      return made;
    }
    case ExpressionToken::Kind::quoted:
      if (!advance()) return std::nullopt;
      return series(word);
    case ExpressionToken::Kind::name:
      if (!advance()) return std::nullopt;
      return is_symbol("(") ? call(word) : name(word);
    case ExpressionToken::Kind::end: return fail(word.begin, "the expression ends where a value is expected");
    case ExpressionToken::Kind::symbol: break;
  }
  if (!is_symbol("(")) return fail(word.begin, fmt::format("expected a value before '{}'", word.text));
  if (!advance()) return std::nullopt;
  const Made inside = any_of();
  if (!inside) return std::nullopt;
  if (token_.kind == ExpressionToken::Kind::end) return fail(word.begin, "this parenthesis isn't closed");
  if (!expect(")", "here")) return std::nullopt;
  return inside;
}

ExpressionParser::Made ExpressionParser::name(const ExpressionToken& word) {
  if (word.text == "tick") return add(Op::tick, Type::number, word.begin, word.end);
  if (word.text == "time") return add(Op::time, Type::number, word.begin, word.end);
  if (word.text == "differs") return add(Op::differs, Type::boolean, word.begin, word.end);
  if (word.text == "true" || word.text == "false") {
    const std::size_t made = add(Op::number, Type::boolean, word.begin, word.end);
    expression_.nodes_[made].number = word.text == "true" ? 1.0 : 0.0;
    return made;
  }
  return series(word);
}

ExpressionParser::Made ExpressionParser::series(const ExpressionToken& word) {
  const auto found = source_.find_series(word.text);
  if (!found) {
    const Diagnostic& why = found.errors().front();
    const bool divides =
        word.kind == ExpressionToken::Kind::name && why.hint.empty() && word.text.find('/') != std::string::npos;
    return fail(word.begin, why.message, divides ? "if it is a division, put blanks around the /" : why.hint);
  }
  const std::size_t made = add(Op::series, Type::number, word.begin, word.end);
  expression_.nodes_[made].series = *found;
  return made;
}

ExpressionParser::Made ExpressionParser::call(const ExpressionToken& word) {
  struct Arithmetic {
    std::string_view name;
    Op op;
    std::size_t arguments;
  };
  static constexpr std::array<Arithmetic, 7> arithmetic{{{"abs", Op::absolute, 1},
                                                         {"min", Op::least, 2},
                                                         {"max", Op::most, 2},
                                                         {"sqrt", Op::square_root, 1},
                                                         {"sin", Op::sine, 1},
                                                         {"cos", Op::cosine, 1},
                                                         {"nan", Op::is_nan, 1}}};
  if (!advance()) return std::nullopt;  // skips the parenthesis
  for (const Arithmetic& function : arithmetic)
    if (word.text == function.name) return arithmetic_call(word, function.op, function.arguments);
  if (word.text == "prev") return shift_call(word, Op::previous);
  if (word.text == "delta") return shift_call(word, Op::delta);
  if (word.text == "changed") return shift_call(word, Op::changed);
  if (word.text == "recorded") return side_call(word, CommandSide::recorded);
  if (word.text == "replayed") return side_call(word, CommandSide::replayed);
  if (word.text == "contact") return contact_call(word);
  if (word.text == "message") return message_call(word);
  return fail(word.begin, fmt::format("there is no function '{}'", word.text), fmt::format("known: {}", functions));
}

ExpressionParser::Made ExpressionParser::arithmetic_call(const ExpressionToken& word, Op op, std::size_t arguments) {
  std::array<std::size_t, 2> of{};
  for (std::size_t i = 0; i < arguments; ++i) {
    if (i > 0 && !expect(",", fmt::format("in {}: it takes two numbers", word.text))) return std::nullopt;
    const Made argument = any_of();
    if (!argument || !demand(*argument, Type::number, word.text)) return std::nullopt;
    of[i] = *argument;
  }
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  return add(op, op == Op::is_nan ? Type::boolean : Type::number, word.begin, last_end_, of[0], of[1]);
}

ExpressionParser::Made ExpressionParser::shift_call(const ExpressionToken& word, Op op) {
  const Deeper deeper(shifts_);
  if (shifts_ > Expression::most_shifts)
    return fail(word.begin,
                fmt::format("prev, delta and changed can be at most {} in each other", Expression::most_shifts));
  const Made of = any_of();
  if (!of) return std::nullopt;
  if (op == Op::delta && !demand(*of, Type::number, word.text)) return std::nullopt;
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  const Type type = op == Op::changed ? Type::boolean : expression_.nodes_[*of].type;
  return add(op, type, word.begin, last_end_, *of);
}

ExpressionParser::Made ExpressionParser::side_call(const ExpressionToken& word, CommandSide side) {
  const ExpressionToken name = token_;
  if (name.kind != ExpressionToken::Kind::name && name.kind != ExpressionToken::Kind::quoted)
    return fail(name.begin, fmt::format("{} takes the name of a command", word.text));
  if (!advance()) return std::nullopt;
  const Made made = series(name);
  if (!made) return std::nullopt;
  Node& node = expression_.nodes_[*made];
  if (!source_.is_replayed(node.series))
    return fail(name.begin, "there is only one value of this: it is no command of a controller that was replayed",
                "recorded and replayed are for series like SR1/SR1Minimum/output/KNEE/u");
  node.side = side;
  if (!expect(")", fmt::format("after the arguments of {}", word.text))) return std::nullopt;
  expression_.nodes_[*made].begin = word.begin;
  expression_.nodes_[*made].end = last_end_;
  return made;
}

std::optional<std::vector<std::size_t>> ExpressionParser::links() {
  const ExpressionToken name = token_;
  if (name.kind != ExpressionToken::Kind::name && name.kind != ExpressionToken::Kind::quoted) {
    fail(name.begin, "contact takes the names of one or two links");
    return std::nullopt;
  }
  auto found = source_.find_links(name.text);
  if (!found) {
    fail(name.begin, found.errors().front().message, found.errors().front().hint);
    return std::nullopt;
  }
  if (!advance()) return std::nullopt;
  return std::move(*found);
}

ExpressionParser::Made ExpressionParser::contact_call(const ExpressionToken& word) {
  auto first = links();
  if (!first) return std::nullopt;
  std::vector<std::size_t> second;
  if (is_symbol(",")) {
    if (!advance()) return std::nullopt;
    auto others = links();
    if (!others) return std::nullopt;
    second = std::move(*others);
  }
  if (!expect(")", "after the links of contact")) return std::nullopt;
  const std::size_t made = add(Op::contact, Type::boolean, word.begin, last_end_);
  expression_.nodes_[made].links = std::move(*first);
  expression_.nodes_[made].others = std::move(second);
  return made;
}

ExpressionParser::Made ExpressionParser::message_call(const ExpressionToken& word) {
  const ExpressionToken pattern = token_;
  if (pattern.kind != ExpressionToken::Kind::quoted)
    return fail(pattern.begin, "message takes a text in quotes", "message(\"*slip*\")");
  if (!advance() || !expect(")", "after the text of message")) return std::nullopt;
  const std::size_t made = add(Op::message, Type::boolean, word.begin, last_end_);
  expression_.nodes_[made].pattern = pattern.text;
  return made;
}

}  // namespace rehearse
