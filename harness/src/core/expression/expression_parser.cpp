#include "expression_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "unit.h"

namespace rehearse {
namespace {

std::string_view word_for(Expression::Type type) {
  constexpr std::array words{"true or false", "a number"};
  return words[static_cast<std::size_t>(type)];
}

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

bool ExpressionParser::have_common_unit(std::size_t left, std::size_t right, std::string_view who) {
  const Node &a = expression_.nodes_[left], &b = expression_.nodes_[right];
  if (common_unit(a.unit, b.unit)) return true;
  fail(b.begin, fmt::format("{} takes numbers of one unit, and these are in {} and {}", who, a.unit, b.unit));
  return false;
}

bool ExpressionParser::demand_instant(std::size_t node, std::string_view who) {
  if (!expression_.nodes_[node].is_temporal) return true;
  fail(expression_.nodes_[node].begin, fmt::format("{} takes a value of one tick, and this has a 'for'", who),
       "conditions with 'for' are combined by &&, || and !");
  return false;
}

ExpressionParser::Made ExpressionParser::finished(std::size_t made) {
  Node& node = expression_.nodes_[made];
  const Node &left = expression_.nodes_[node.left], &right = expression_.nodes_[node.right];
  node.varies = left.varies || right.varies;
  node.is_temporal = node.op == Op::lasting || left.is_temporal || right.is_temporal;
  node.is_in_degrees = left.is_in_degrees || right.is_in_degrees;
  switch (node.op) {
    case Op::multiply: node.unit = unit_of_product(left.unit, right.unit); break;
    case Op::divide: node.unit = unit_of_quotient(left.unit, right.unit); break;
    case Op::square_root:
    case Op::sine:
    case Op::cosine: break;
    default: node.unit = common_unit(left.unit, right.unit).value_or("");
  }
  return made;
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
  const auto found = std::ranges::find_if(operators, [this](const Operator& o) { return is_symbol(o.symbol); });
  return found == operators.end() ? nullptr : &*found;
}

ExpressionParser::Made ExpressionParser::chain(Rule operand, std::initializer_list<Operator> operators, Type type) {
  Made left = (this->*operand)();
  while (const Operator* here = left ? operator_here(operators) : nullptr) {
    if (!demand(*left, type, here->symbol) || !advance()) return std::nullopt;
    const Made right = (this->*operand)();
    if (!right || !demand(*right, type, here->symbol)) return std::nullopt;
    const bool is_sum = here->op == Op::add || here->op == Op::subtract;
    if (is_sum && !have_common_unit(*left, *right, here->symbol)) return std::nullopt;
    left = finished(add(here->op, type, expression_.nodes_[*left].begin, last_end_, *left, *right));
  }
  return left;
}

ExpressionParser::Made ExpressionParser::comparison() {
  Made made = single_comparison();
  while (made && token_.kind == ExpressionToken::Kind::name && token_.text == "for") {
    if (!demand(*made, Type::boolean, "for") || !advance()) return std::nullopt;
    const std::optional<double> time = duration("after 'for'");
    if (!time) return std::nullopt;
    const std::size_t lasting =
        add(Op::lasting, Type::boolean, expression_.nodes_[*made].begin, last_end_, *made, *made);
    expression_.nodes_[lasting].number = *time;
    made = finished(lasting);
  }
  return made;
}

/// A time that is at least 0 [s].
std::optional<double> ExpressionParser::duration(std::string_view where) {
  const bool is_time = token_.kind == ExpressionToken::Kind::number && (token_.unit == "s" || token_.unit.empty());
  if (!is_time) {
    fail(token_.begin, fmt::format("expected a time {}", where), "as 0.2 s or 20 ms");
    return std::nullopt;
  }
  const double time = token_.number;
  if (!advance()) return std::nullopt;
  return time;
}

ExpressionParser::Made ExpressionParser::single_comparison() {
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
  if (!demand_instant(*left, here->symbol) || !demand_instant(*right, here->symbol)) return std::nullopt;
  if (!have_common_unit(*left, *right, here->symbol)) return std::nullopt;
  return finished(add(here->op, Type::boolean, expression_.nodes_[*left].begin, last_end_, *left, *right));
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
    return finished(add(negates ? Op::negate : Op::logical_not, negates ? Type::number : Type::boolean, begin,
                        last_end_, *of, *of));
  }
  return primary();
}

ExpressionParser::Made ExpressionParser::primary() {
  const ExpressionToken word = token_;
  switch (word.kind) {
    case ExpressionToken::Kind::number: {
      if (!advance()) return std::nullopt;
      const std::size_t made = add(Op::number, Type::number, word.begin, word.end);
      Node& node = expression_.nodes_[made];
      node.number = word.number;
      node.unit = word.unit;
      node.is_in_degrees = word.degrees;
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
  const bool is_truth = word.text == "true" || word.text == "false";
  const bool is_number = word.text == "tick" || word.text == "time";
  if (!is_truth && !is_number && word.text != "differs") return series(word);
  if (word.text == "differs" && !source_.has_replay())
    return fail(word.begin, "nothing is replayed here that could differ", "differs is for replay and step");
  const Op op = is_truth ? Op::number : word.text == "tick" ? Op::tick : word.text == "time" ? Op::time : Op::differs;
  const std::size_t made = add(op, is_number ? Type::number : Type::boolean, word.begin, word.end);
  Node& node = expression_.nodes_[made];
  node.varies = !is_truth;
  if (is_truth) node.number = word.text == "true" ? 1.0 : 0.0;
  if (op == Op::time) node.unit = "s";
  return made;
}

ExpressionParser::Made ExpressionParser::series(const ExpressionToken& word) {
  const auto found = source_.find_series(word.text);
  if (!found) {
    const Made derived = derived_series(word);
    if (derived || failed_) return derived;
    const Diagnostic& why = found.errors().front();
    const bool divides =
        word.kind == ExpressionToken::Kind::name && why.hint.empty() && word.text.find('/') != std::string::npos;
    return fail(word.begin, why.message, divides ? "if it is a division, put blanks around the /" : why.hint);
  }
  const std::size_t made = add(Op::series, Type::number, word.begin, word.end);
  Node& node = expression_.nodes_[made];
  node.series = *found;
  node.unit = comparable_unit(source_.unit_of_series(*found));
  node.varies = true;
  return made;
}

ExpressionParser::Made ExpressionParser::derived_series(const ExpressionToken& word) {
  const std::size_t slash = word.text.rfind('/');
  if (slash == std::string::npos) return std::nullopt;
  const std::string link = word.text.substr(0, slash), last = word.text.substr(slash + 1);
  if (last == "x" || last == "y" || last == "z") {
    const auto position = source_.find_series(link + "/position/" + last);
    if (!position) return std::nullopt;
    const std::size_t made = add(Op::series, Type::number, word.begin, word.end);
    Node& node = expression_.nodes_[made];
    node.series = *position;
    node.unit = comparable_unit(source_.unit_of_series(*position));
    node.varies = true;
    return made;
  }
  if (last != "roll" && last != "pitch" && last != "yaw") return std::nullopt;
  std::vector<std::size_t> parts;
  for (const char* part : {"x", "y", "z", "w"}) {
    const auto found = source_.find_series(link + "/orientation/" + part);
    if (!found) return std::nullopt;
    parts.push_back(*found);
  }
  const Op op = last == "roll" ? Op::roll : last == "pitch" ? Op::pitch : Op::yaw;
  const std::size_t made = add(op, Type::number, word.begin, word.end);
  Node& node = expression_.nodes_[made];
  node.links = std::move(parts);
  node.unit = "rad";
  node.varies = true;
  return made;
}

}  // namespace rehearse
