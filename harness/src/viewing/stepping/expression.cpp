#include "expression.h"

#include <rehearse/compare.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "expression_parser.h"

namespace rehearse {

bool Expression::holds(ExpressionSource& source, std::int64_t tick) const {
  REHEARSE_ASSERT(type() == Type::boolean, "the expression is true or false");
  return evaluate(root_, source, tick) != 0.0;
}

double Expression::number(ExpressionSource& source, std::int64_t tick) const { return evaluate(root_, source, tick); }

double Expression::number_of(const Operand& operand, ExpressionSource& source, std::int64_t tick) const {
  return evaluate(operand.node, source, tick);
}

std::vector<Expression::Operand> Expression::operands() const {
  std::vector<Operand> all;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.op != Op::series && node.op != Op::contact && node.op != Op::message) continue;
    Operand operand{text_.substr(node.begin, node.end - node.begin), i};
    const bool known = std::any_of(all.begin(), all.end(), [&](const Operand& o) { return o.text == operand.text; });
    if (!known) all.push_back(std::move(operand));
  }
  std::stable_sort(all.begin(), all.end(),
                   [this](const Operand& a, const Operand& b) { return nodes_[a.node].begin < nodes_[b.node].begin; });
  return all;
}

/// Compares bits: a NaN that stays the same NaN hasn't changed.
bool Expression::differs_from_before(std::size_t node, ExpressionSource& source, std::int64_t tick) const {
  return tick > source.first_tick() && !identical(evaluate(node, source, tick), evaluate(node, source, tick - 1));
}

/// Nodes come after their operands, so this ends; the length of the text limits the depth.
double Expression::evaluate(std::size_t index, ExpressionSource& source, std::int64_t tick) const {
  const Node& node = nodes_[index];
  const auto left = [&] { return evaluate(node.left, source, tick); };
  const auto right = [&] { return evaluate(node.right, source, tick); };
  const bool has_before = tick > source.first_tick();
  switch (node.op) {
    case Op::number: return node.number;
    case Op::tick: return static_cast<double>(tick);
    case Op::time: return source.time_at(tick);
    case Op::differs: return source.differs_at(tick) ? 1.0 : 0.0;
    case Op::series: return source.value(node.series, tick, node.side);
    case Op::contact: return source.touching(node.links, node.others, tick) ? 1.0 : 0.0;
    case Op::message: return source.said(node.pattern, tick) ? 1.0 : 0.0;
    case Op::negate: return -left();
    case Op::logical_not: return left() == 0.0 ? 1.0 : 0.0;
    case Op::add: return left() + right();
    case Op::subtract: return left() - right();
    case Op::multiply: return left() * right();
    case Op::divide: return left() / right();
    case Op::less: return left() < right() ? 1.0 : 0.0;
    case Op::less_equal: return left() <= right() ? 1.0 : 0.0;
    case Op::greater: return left() > right() ? 1.0 : 0.0;
    case Op::greater_equal: return left() >= right() ? 1.0 : 0.0;
    case Op::equal: return left() == right() ? 1.0 : 0.0;
    case Op::unequal: return left() != right() ? 1.0 : 0.0;
    case Op::logical_and: return left() != 0.0 && right() != 0.0 ? 1.0 : 0.0;
    case Op::logical_or: return left() != 0.0 || right() != 0.0 ? 1.0 : 0.0;
    case Op::absolute: return std::abs(left());
    case Op::least: {
      const double a = left(), b = right();
      return std::isnan(a) ? a : b < a || std::isnan(b) ? b : a;
    }
    case Op::most: {
      const double a = left(), b = right();
      return std::isnan(a) ? a : b > a || std::isnan(b) ? b : a;
    }
    case Op::square_root: return std::sqrt(left());
    case Op::sine: return std::sin(left());
    case Op::cosine: return std::cos(left());
    case Op::is_nan: return std::isnan(left()) ? 1.0 : 0.0;
    case Op::previous:
      if (has_before) return evaluate(node.left, source, tick - 1);
      return node.type == Type::boolean ? 0.0 : std::numeric_limits<double>::quiet_NaN();
    case Op::delta:
      return has_before ? left() - evaluate(node.left, source, tick - 1) : std::numeric_limits<double>::quiet_NaN();
    case Op::changed: return differs_from_before(node.left, source, tick) ? 1.0 : 0.0;
  }
  return 0.0;
}

}  // namespace rehearse
