#include "mutation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace rehearse {
namespace {

/// The number with so many digits after the point, or before it if negative.
double rounded(double value, int digits) {
  const double unit = std::pow(10.0, digits);
  return std::round(value * unit) / unit;
}

}  // namespace

Mutator::Span Mutator::span(Dice& dice) const {
  if (dice.happens(0.3)) return {0, ticks_};
  const int from = static_cast<int>(dice.below(static_cast<std::size_t>(ticks_)));
  if (dice.happens(0.3)) return {from, from + 1};
  const int longest = ticks_ - from;
  return {from, from + 1 + static_cast<int>(dice.below(static_cast<std::size_t>(longest)))};
}

/// Any value of the range, a round one, an end of the range, or one near to an end or to the start.
double Mutator::value(const InputColumn& column, Dice& dice) const {
  const double kind = dice.uniform();
  const double any = dice.between(column.low, column.high);
  if (kind < 0.5) return any;
  if (kind < 0.65) {
    const double span = column.high - column.low;
    const int digits =
        span > 0.0 ? static_cast<int>(dice.below(3)) - static_cast<int>(std::floor(std::log10(span))) : 0;
    return column.clamped(rounded(any, digits));
  }
  const double places[] = {column.low, column.high, column.start, 0.0};
  const double place = places[dice.below(4)];
  if (kind < 0.85) return column.clamped(place);
  const double distance = (column.high - column.low) * std::exp2(-static_cast<double>(dice.below(30)));
  return column.clamped(dice.happens(0.5) ? place + distance : place - distance);
}

/// A smooth curve through some knots, or straight lines between them.
void Mutator::fill_spline(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const {
  const bool is_smooth = dice.happens(0.5);
  const auto knots = 2 + static_cast<int>(dice.below(5));
  double from = value(columns_[column], dice), to = value(columns_[column], dice);
  const int length = span.until - span.from;
  int piece = 0;
  for (int tick = span.from; tick < span.until; ++tick) {
    const double at = static_cast<double>(tick - span.from) / std::max(1, length - 1) * (knots - 1);
    if (static_cast<int>(at) > piece) {
      piece = static_cast<int>(at);
      from = to;
      to = value(columns_[column], dice);
    }
    double share = at - piece;
    if (is_smooth) share = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
    inputs.at(tick, column) = from + (to - from) * share;
  }
}

void Mutator::fill(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const {
  const double kind = dice.uniform();
  if (kind < 0.25) {
    fill_spline(inputs, column, span, dice);
    return;
  }
  const double first = value(columns_[column], dice);
  const double change = kind < 0.5    ? 0.0                                                // constant
                        : kind < 0.75 ? dice.between(0.5, 6.0) / (span.until - span.from)  // steps
                        : kind < 0.9  ? 0.0                                                // and single ticks
                                      : 1.0;                                                // noise
  double now = first;
  for (int tick = span.from; tick < span.until; ++tick) {
    if (tick > span.from && dice.happens(change)) now = value(columns_[column], dice);
    inputs.at(tick, column) = now;
  }
  if (kind < 0.75 || kind >= 0.9) return;
  for (std::size_t left = 1 + dice.below(4); left > 0; --left) {
    const int tick = span.from + static_cast<int>(dice.below(static_cast<std::size_t>(span.until - span.from)));
    inputs.at(tick, column) = value(columns_[column], dice);
  }
}

Inputs Mutator::fresh(Dice& dice) const {
  Inputs inputs = inputs_at_start(columns_, ticks_);
  for (std::size_t column = 0; column < columns_.size(); ++column) fill(inputs, column, {0, ticks_}, dice);
  return inputs;
}

void Mutator::nudge(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const {
  const InputColumn& of = columns_[column];
  const double size = (of.high - of.low) * std::exp2(-1.0 - static_cast<double>(dice.below(16)));
  const double by = dice.between(-size, size), times = dice.happens(0.2) ? dice.between(-2.0, 2.0) : 1.0;
  for (int tick = span.from; tick < span.until; ++tick)
    inputs.at(tick, column) = of.clamped(inputs.at(tick, column) * times + by);
}

/// Exchanges two sensors that measure alike.
void Mutator::swap_alike(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const {
  const std::size_t other = dice.below(columns_.size());
  if (other == column || !columns_[other].is_like(columns_[column])) return nudge(inputs, column, span, dice);
  for (int tick = span.from; tick < span.until; ++tick) {
    const double kept = inputs.at(tick, column);
    inputs.at(tick, column) = columns_[column].clamped(inputs.at(tick, other));
    inputs.at(tick, other) = columns_[other].clamped(kept);
  }
}

void Mutator::splice(Inputs& inputs, const Inputs& other, std::size_t column, const Span& span, Dice& dice) const {
  if (other.ticks() == 0) return fill(inputs, column, span, dice);
  const bool is_of_all = dice.happens(0.5);
  for (int tick = span.from; tick < span.until; ++tick) {
    const int from = std::min(tick, other.ticks() - 1);
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (is_of_all || i == column) inputs.at(tick, i) = columns_[i].clamped(other.at(from, i));
  }
}

/// Copies a span to another time.
void Mutator::move(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const {
  const Inputs before = inputs;
  const int to = static_cast<int>(dice.below(static_cast<std::size_t>(ticks_)));
  const bool is_of_all = dice.happens(0.5);
  for (int tick = span.from; tick < span.until && to + tick - span.from < ticks_; ++tick)
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (is_of_all || i == column) inputs.at(to + tick - span.from, i) = before.at(tick, i);
}

/// Moves an input on which an operand may depend by about the distance of the operands: by all of it and a little more
/// in |x - c| < d.
void Mutator::approach(Inputs& inputs, const SeenComparison& hint, const std::vector<std::size_t>& columns,
                       Dice& dice) const {
  const std::size_t column =
      !columns.empty() && dice.happens(0.75) ? columns[dice.below(columns.size())] : dice.below(columns_.size());
  const Span where = dice.happens(0.6) ? Span{0, ticks_} : span(dice);
  const double little = std::min(std::abs(hint.a), std::abs(hint.b));
  double by = hint.distance + dice.between(0.0, 2.0) * std::min(little, hint.distance);
  if (dice.happens(0.3)) by = hint.distance * dice.between(0.0, 2.0);
  if (dice.happens(0.5)) by = -by;
  for (int tick = where.from; tick < where.until; ++tick)
    inputs.at(tick, column) = columns_[column].clamped(inputs.at(tick, column) + by);
}

/// Where an operand of a comparison is an input, gives it the value of the other operand, or one just beside it.
bool Mutator::follow(Inputs& inputs, const std::vector<SeenComparison>& hints, const std::vector<std::size_t>& columns,
                     Dice& dice) const {
  if (hints.empty()) return false;
  const SeenComparison& hint = hints[dice.below(hints.size())];
  if (!std::isfinite(hint.distance)) return false;
  std::vector<std::pair<int, std::size_t>> places;
  bool is_first = dice.happens(0.5), is_negative = false;
  for (int way = 0; way < 4 && places.empty(); ++way) {
    if (way == 2) is_negative = true;
    if (way > 0) is_first = !is_first;
    const double wanted = (is_negative ? -1.0 : 1.0) * (is_first ? hint.a : hint.b);
    for (int tick = 0; tick < ticks_; ++tick)
      for (std::size_t column = 0; column < columns_.size(); ++column)
        if (inputs.at(tick, column) == wanted) places.emplace_back(tick, column);
  }
  double other = is_first ? hint.b : hint.a;
  if (places.empty()) {
    approach(inputs, hint, columns, dice);
    return true;
  }
  if (is_negative) other = -other;
  const double beside = dice.uniform();
  const double step = std::max(std::abs(other), 1.0) * std::exp2(-static_cast<double>(dice.below(40)));
  if (beside > 0.7)
    other += step;
  else if (beside > 0.4)
    other -= step;
  const auto [from, column] = places[dice.below(places.size())];
  const double before = inputs.at(from, column);
  const bool is_all = dice.happens(0.5);  // as long as the input stays
  for (int tick = from; tick < ticks_ && (tick == from || (is_all && inputs.at(tick, column) == before)); ++tick)
    inputs.at(tick, column) = columns_[column].clamped(other);
  return true;
}

void Mutator::change(Inputs& inputs, const Inputs& other, const std::vector<SeenComparison>& hints, Dice& dice) const {
  if (dice.happens(0.35) && follow(inputs, hints, {}, dice)) return;
  const std::size_t column = dice.below(columns_.size());
  const Span where = span(dice);
  const double kind = dice.uniform();
  if (kind < 0.25) {
    fill(inputs, column, where, dice);
  } else if (kind < 0.45) {
    const double constant = value(columns_[column], dice);
    for (int tick = where.from; tick < where.until; ++tick) inputs.at(tick, column) = constant;
  } else if (kind < 0.55) {
    const double stuck = inputs.at(where.from, column);
    for (int tick = where.from; tick < where.until; ++tick) inputs.at(tick, column) = stuck;
  } else if (kind < 0.72) {
    nudge(inputs, column, where, dice);
  } else if (kind < 0.77) {
    swap_alike(inputs, column, where, dice);
  } else if (kind < 0.9) {
    splice(inputs, other, column, where, dice);
  } else {
    move(inputs, column, where, dice);
  }
}

Inputs Mutator::mutated(const Inputs& inputs, const Inputs& other, const std::vector<SeenComparison>& hints,
                        bool is_aimed, const std::vector<std::size_t>& columns, Dice& dice) const {
  Inputs made = inputs;
  if (made.ticks() < ticks_) {  // of a recording that is shorter: the last values stay
    const int known = made.ticks();
    made.values.resize(columns_.size() * static_cast<std::size_t>(ticks_));
    for (int tick = known; tick < ticks_; ++tick)
      for (std::size_t column = 0; column < columns_.size(); ++column)
        made.at(tick, column) = known > 0 ? made.at(known - 1, column) : columns_[column].start;
  }
  if (is_aimed && follow(made, hints, columns, dice) && dice.happens(0.75)) return made;
  for (std::size_t left = 1 + dice.below(4); left > 0; --left) change(made, other, hints, dice);
  return made;
}

}  // namespace rehearse
