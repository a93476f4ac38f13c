#include "reading_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/chance.h"

namespace rehearse {
namespace {

constexpr double rounding = 1e-9;  // [ticks]: 6 ms are 6 ticks of 1 ms, whatever their quotient rounds to

// Places of random numbers, different from those of the values of a sample.
constexpr std::uint64_t place_of_jitter = 1ull << 61;
constexpr std::uint64_t place_of_gap = (1ull << 61) + 1;

std::int64_t ticks_until(double delay, double time_step) {
  const double ticks = delay / time_step;
  return static_cast<std::int64_t>(std::ceil(ticks - rounding * std::max(1.0, ticks)));
}

double longest_delay(const ReadingErrors& errors) {
  double longest = errors.latency + errors.jitter;
  for (const ExtraDelay& extra : errors.delayed) longest += extra.by;
  return longest;
}

}  // namespace

ReadingLine::ReadingLine(const ReadingErrors& errors, std::uint64_t key, double time_step, double interval,
                         std::size_t numbers)
    : errors_(errors),
      key_(key),
      time_step_(time_step),
      interval_(errors.rate > 0.0 ? std::max(1.0 / errors.rate, time_step) : interval) {
  waiting_.resize(static_cast<std::size_t>(ticks_until(longest_delay(errors), time_step)) + 1);
  for (Arrival& arrival : waiting_) arrival.values.resize(numbers);
  last_.values.resize(numbers);
  repeated_.values.resize(numbers);
}

std::optional<std::int64_t> ReadingLine::sample_of(std::int64_t tick) const {
  if (errors_.rate <= 0.0) return tick;
  const auto samples_until = [this](std::int64_t at) {
    return static_cast<std::int64_t>(std::floor((time_of_tick(at) - errors_.phase) * errors_.rate + rounding));
  };
  const std::int64_t sample = samples_until(tick);
  if (sample < 0 || sample == samples_until(tick - 1)) return std::nullopt;
  return errors_.rate * time_step_ > 1.0 ? tick : sample;
}

std::int64_t ReadingLine::arrival_of(std::int64_t tick) const {
  double delay = errors_.latency;
  if (errors_.jitter > 0.0) delay += errors_.jitter * (2.0 * Chance(key_, tick).uniform(place_of_jitter) - 1.0);
  for (const ExtraDelay& extra : errors_.delayed)
    if (extra.when.holds(time_of_tick(tick))) delay += extra.by;
  return tick + ticks_until(std::max(delay, 0.0), time_step_);
}

/// A gap ends with each sample with the chance 1 / its mean length; the chance that one begins gives the share.
bool ReadingLine::is_lost(std::int64_t tick, std::int64_t sample) {
  const double time = time_of_tick(tick);
  if (std::ranges::any_of(errors_.lost, [&](const Spell& each) { return each.holds(time); })) return true;
  if (errors_.burst <= 0.0 || errors_.dropout <= 0.0) return false;
  if (errors_.dropout >= 1.0) return true;
  const double ends = std::min(1.0, interval_ / errors_.burst);
  const double begins = std::min(1.0, ends * errors_.dropout / (1.0 - errors_.dropout));
  for (; chain_ < sample; ++chain_) {
    const double draw = Chance(key_, chain_ + 1).uniform(place_of_gap);
    in_gap_ = draw < (chain_ < 0 ? errors_.dropout : in_gap_ ? 1.0 - ends : begins);
  }
  return in_gap_;
}

bool ReadingLine::is_stuck(std::int64_t tick) const {
  const double time = time_of_tick(tick);
  return std::ranges::any_of(errors_.stuck, [&](const Spell& each) { return each.holds(time); });
}

bool ReadingLine::pass(std::int64_t tick, std::optional<std::int64_t> sample, std::vector<double>& values) {
  const auto now = static_cast<double>(tick);
  if (now_ < 0.0) last_.values = values;  // until the first sample arrives
  if (now_ != now) before_ = last_.taken;
  now_ = now;
  const auto size = static_cast<std::int64_t>(waiting_.size());
  Arrival& taken = waiting_[static_cast<std::size_t>(tick % size)];
  taken.taken = -1.0;
  if (sample) {
    if (!is_stuck(tick) || repeated_.taken < 0.0) {
      repeated_.taken = now;
      repeated_.values = values;
    }
    if (!is_lost(tick, *sample)) {
      taken.taken = now;
      taken.arrives = static_cast<double>(arrival_of(tick));
      taken.values = repeated_.values;
    }
  }
  for (std::int64_t age = 0; age < std::min(size, tick + 1); ++age) {
    const Arrival& arrival = waiting_[static_cast<std::size_t>((tick - age) % size)];
    if (static_cast<double>(tick - age) <= last_.taken) break;
    if (arrival.taken != static_cast<double>(tick - age) || arrival.arrives > now) continue;
    last_ = arrival;
    break;
  }
  values = last_.values;
  return last_.taken != before_;
}

}  // namespace rehearse
