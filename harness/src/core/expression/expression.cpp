#include "expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "expression_parser.h"
#include "unit.h"

namespace rehearse {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

constexpr Causes no_tick_before{.missing = true};

Causes causes_of(ExpressionSource::Sampled sampled) {
  using Sampled = ExpressionSource::Sampled;
  return {.missing = sampled != Sampled::yes, .blank = sampled == Sampled::blank};
}

/// Certain, unless something is missing.
Judged unless(bool holds, const Causes& absence) { return absence.missing ? unknown(holds, absence) : certain(holds); }

bool have_equal_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

}  // namespace

Result<std::size_t> ExpressionSource::find_joint_series(std::string_view joint, std::string_view, bool) {
  return error(fmt::format("there is no joint '{}' here", joint));
}

Result<JointLimit> ExpressionSource::find_limit(std::string_view joint, std::string_view) {
  return error(fmt::format("there is no joint '{}' here", joint));
}

bool Expression::holds(ExpressionSource& source, std::int64_t tick) const {
  REHEARSE_ASSERT(type() == Type::boolean, "the expression is true or false");
  return judge({source, tick}, root_).holds;
}

double Expression::number(ExpressionSource& source, std::int64_t tick) const { return evaluate({source, tick}, root_); }

double Expression::number_of(const Operand& operand, ExpressionSource& source, std::int64_t tick) const {
  return evaluate({source, tick}, operand.node);
}

std::vector<Expression::Operand> Expression::operands() const {
  std::vector<Operand> all;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.op != Op::series && node.op != Op::contact && node.op != Op::message && node.op != Op::event) continue;
    Operand operand{text_.substr(node.begin, node.end - node.begin), i};
    const bool known = std::ranges::any_of(all, [&](const Operand& o) { return o.text == operand.text; });
    if (!known) all.push_back(std::move(operand));
  }
  std::ranges::stable_sort(
      all, [this](const Operand& a, const Operand& b) { return nodes_[a.node].begin < nodes_[b.node].begin; });
  return all;
}

std::vector<Expression::Moment> Expression::moments() const {
  std::vector<Moment> all;
  for (const Node& node : nodes_)
    if (node.op == Op::value_at) all.push_back({node.series, node.number});
  return all;
}

Expression::Part Expression::part(std::size_t index) const {
  const Node& node = nodes_[index];
  if (!node.is_temporal) return {};
  switch (node.op) {
    case Op::logical_not: return {Part::Kind::negation, node.left, node.left};
    case Op::logical_and: return {Part::Kind::conjunction, node.left, node.right};
    case Op::logical_or: return {Part::Kind::disjunction, node.left, node.right};
    default: return {Part::Kind::lasting, node.left, node.left, node.number};
  }
}

bool Expression::has_margin(std::size_t index) const {
  const Node& node = nodes_[index];
  switch (node.op) {
    case Op::less:
    case Op::less_equal:
    case Op::greater:
    case Op::greater_equal: return true;
    case Op::equal:
    case Op::unequal: return nodes_[node.left].type == Type::number;
    case Op::logical_and:
    case Op::logical_or: return has_margin(node.left) || has_margin(node.right);
    case Op::logical_not:
    case Op::lasting: return has_margin(node.left);
    case Op::previous: return node.type == Type::boolean && has_margin(node.left);
    default: return false;
  }
}

std::string Expression::comparison_text(const Judgement& judgement) const {
  const Node& node = nodes_[judgement.comparison];
  return quantities_text(judgement.value, judgement.bound, node.unit, node.is_in_degrees);
}

std::vector<std::size_t> Expression::series() const {
  std::set<std::size_t> all;
  for (const Node& node : nodes_) {
    if (node.op == Op::series || node.op == Op::value_at) all.insert(node.series);
    if (node.op == Op::roll || node.op == Op::pitch || node.op == Op::yaw)
      all.insert(node.links.begin(), node.links.end());
  }
  return {all.begin(), all.end()};
}

Causes Expression::absence(const At& at, std::size_t index) const {
  const Node& node = nodes_[index];
  if (node.type == Type::boolean) {
    const Judged judged = judge(at, index);
    return judged.is_before_span() ? judged.causes : Causes{};
  }
  const auto of_series = [&](std::size_t series) { return causes_of(at.source.sampled(series, at.tick, node.side)); };
  switch (node.op) {
    case Op::series: return of_series(node.series);
    case Op::value_at: return causes_of(at.source.sampled_at(node.series, node.number, at.tick));
    case Op::roll:
    case Op::pitch:
    case Op::yaw: {
      Causes causes;
      for (const std::size_t series : node.links) causes = causes | of_series(series);
      return causes;
    }
    case Op::previous:
      if (at.tick <= at.source.first_tick()) return no_tick_before;
      return absence({at.source, at.tick - 1}, node.left);
    case Op::delta: return absence_of_change(at, node.left);
    case Op::negate:
    case Op::absolute:
    case Op::square_root:
    case Op::sine:
    case Op::cosine: return absence(at, node.left);
    case Op::add:
    case Op::subtract:
    case Op::multiply:
    case Op::divide:
    case Op::least:
    case Op::most: return absence(at, node.left) | absence(at, node.right);
    default: return {};
  }
}

Causes Expression::absence_of_change(const At& at, std::size_t index) const {
  if (at.tick <= at.source.first_tick()) return no_tick_before;
  return absence(at, index) | absence({at.source, at.tick - 1}, index);
}

/// Compares bits: a NaN that stays the same NaN hasn't changed.
bool Expression::differs_from_before(const At& at, std::size_t node) const {
  return at.tick > at.source.first_tick() &&
         !have_equal_bits(evaluate(at, node), evaluate({at.source, at.tick - 1}, node));
}

/// True if the number changes by more than the size of a jump, or without a size by more than ten times its change in
/// the tick before.
bool Expression::jumps(const At& at, const Node& node) const {
  const std::int64_t first = at.source.first_tick();
  if (at.tick <= first) return false;
  const double now = evaluate(at, node.left), before = evaluate({at.source, at.tick - 1}, node.left);
  const double change = std::abs(now - before);
  if (node.right != node.left) return change > evaluate(at, node.right);
  const double earlier = at.tick - 1 > first ? evaluate({at.source, at.tick - 2}, node.left) : before;
  const double change_before = std::abs(before - earlier);
  return change > 10.0 * (std::isnan(change_before) ? 0.0 : change_before);
}

/// An angle of the rotation Rz(yaw) Ry(pitch) Rx(roll) that a unit quaternion describes [rad].
double Expression::orientation(const At& at, const Node& node) const {
  const auto part = [&](std::size_t i) { return at.source.value(node.links[i], at.tick, CommandSide::recorded); };
  const double x = part(0), y = part(1), z = part(2), w = part(3);
  if (node.op == Op::roll) return std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
  if (node.op == Op::yaw) return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  const double sine = 2.0 * (w * y - z * x);
  return std::isnan(sine) ? sine : std::asin(std::clamp(sine, -1.0, 1.0));
}

/// Nodes come after their operands, so this ends; the length of the text limits the depth.
double Expression::evaluate(const At& at, std::size_t index) const {
  const Node& node = nodes_[index];
  if (node.type == Type::boolean) return judge({at.source, at.tick}, index).holds ? 1.0 : 0.0;
  const auto left = [&] { return evaluate(at, node.left); };
  const auto right = [&] { return evaluate(at, node.right); };
  const bool has_before = at.tick > at.source.first_tick();
  switch (node.op) {
    case Op::number: return node.number;
    case Op::tick: return static_cast<double>(at.source.number_of(at.tick));
    case Op::time: return at.source.time_at(at.tick);
    case Op::series: return at.source.value(node.series, at.tick, node.side);
    case Op::value_at: return at.source.value_at(node.series, node.number, at.tick);
    case Op::roll:
    case Op::pitch:
    case Op::yaw: return orientation(at, node);
    case Op::negate: return -left();
    case Op::add: return left() + right();
    case Op::subtract: return left() - right();
    case Op::multiply: return left() * right();
    case Op::divide: return left() / right();
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
    case Op::previous: return has_before ? evaluate({at.source, at.tick - 1}, node.left) : not_a_number;
    case Op::delta: return has_before ? left() - evaluate({at.source, at.tick - 1}, node.left) : not_a_number;
    default: return not_a_number;
  }
}

Judged Expression::compared(const At& at, std::size_t index) const {
  const Node& node = nodes_[index];
  if (nodes_[node.left].type == Type::boolean) {
    const Judged a = judge(at, node.left), b = judge(at, node.right);
    const bool is_known = a.worst.truth == a.best.truth && b.worst.truth == b.best.truth;
    const bool holds = (a.holds == b.holds) == (node.op == Op::equal);
    return is_known ? certain(holds) : unknown(holds, a.causes | b.causes);
  }
  const double a = evaluate(at, node.left), b = evaluate(at, node.right);
  if (std::isnan(a) || std::isnan(b)) {
    const Causes causes = absence(at, node.left) | absence(at, node.right);
    return unknown(node.op == Op::unequal, causes.missing ? causes : Causes{.nan = true});
  }
  const double distance = a == b ? 0.0 : b - a;  // infinities may be equal
  Judgement judgement;
  switch (node.op) {
    case Op::less: judgement.truth = a < b, judgement.margin = distance; break;
    case Op::less_equal: judgement.truth = a <= b, judgement.margin = distance; break;
    case Op::greater: judgement.truth = a > b, judgement.margin = -distance; break;
    case Op::greater_equal: judgement.truth = a >= b, judgement.margin = -distance; break;
    case Op::equal: judgement.truth = a == b, judgement.margin = -std::abs(distance); break;
    default: judgement.truth = a != b, judgement.margin = std::abs(distance); break;
  }
  const bool is_bound_left = !nodes_[node.left].varies && nodes_[node.right].varies;
  judgement.value = is_bound_left ? b : a;
  judgement.bound = is_bound_left ? a : b;
  judgement.comparison = index;
  return {judgement.truth, judgement, judgement, {}, 0};
}

/// True if the condition holds from this tick on for a time. A time that the run's end cuts isn't known to be true.
Judged Expression::lasting(const At& at, const Node& node) const {
  const double end = at.source.time_at(at.tick) + node.number + 1e-9;
  Judged all = certain(true);
  for (At later = at;; ++later.tick) {
    if (later.tick > at.source.last_tick()) return both(all, unknown(false, {.cut = true}));
    if (at.source.time_at(later.tick) > end) return all;
    all = both(all, judge(later, node.left));
    if (!at.margins && !all.holds) return all;
  }
}

Judged Expression::judge(const At& at, std::size_t index) const {
  const Node& node = nodes_[index];
  switch (node.op) {
    case Op::number: return certain(node.number != 0.0);
    case Op::differs: return certain(at.source.differs_at(at.tick));
    case Op::contact: return certain(at.source.touching(node.links, node.others, at.tick));
    case Op::message: return certain(at.source.said(node.pattern, at.tick));
    case Op::event: return certain(at.source.happened(node.pattern, at.tick));
    case Op::is_nan: return unless(std::isnan(evaluate(at, node.left)), absence(at, node.left));
    case Op::changed: return unless(differs_from_before(at, node.left), absence_of_change(at, node.left));
    case Op::step: return unless(jumps(at, node), absence_of_change(at, node.left));
    case Op::previous:
      if (at.tick <= at.source.first_tick()) return unknown(false, no_tick_before);
      return judge({at.source, at.tick - 1, at.margins}, node.left);
    case Op::logical_not: return negated(judge(at, node.left));
    case Op::lasting: return lasting(at, node);
    case Op::logical_and:
    case Op::logical_or: {
      const bool is_or = node.op == Op::logical_or;
      const Judged left = judge(at, node.left);
      if (!at.margins && left.holds == is_or) return left;
      return is_or ? either(left, judge(at, node.right)) : both(left, judge(at, node.right));
    }
    default: return compared(at, index);
  }
}

}  // namespace rehearse
