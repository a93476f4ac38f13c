#include "log_ticks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/clock.h"

namespace rehearse {

int DurationCounts::bin_of(std::int64_t duration) const {
  const auto number = static_cast<std::uint64_t>(duration);
  const int shift = std::max(0, static_cast<int>(std::bit_width(number)) - bits_);
  return (shift << bits_) + static_cast<int>(number >> shift);  // from the first shift on, half of them are used
}

void DurationCounts::add(std::int64_t duration) {
  Bin& bin = bins_[bin_of(duration)];
  ++bin.count;
  bin.sum += static_cast<double>(duration);
  ++all_;
}

std::int64_t DurationCounts::quantile(double share) const {
  std::int64_t before = 0;
  for (const auto& [number, bin] : bins_)
    if (static_cast<double>(before += bin.count) >= share * static_cast<double>(all_))
      return std::llround(bin.sum / static_cast<double>(bin.count));
  return 0;
}

bool DurationCounts::is_regular() const {
  const auto usual = static_cast<double>(median());
  std::int64_t near = 0;
  for (const auto& [number, bin] : bins_) {
    const double mean = bin.sum / static_cast<double>(bin.count);
    if (mean >= 0.5 * usual && mean <= 1.5 * usual) near += bin.count;
  }
  return all_ > 0 && near * 10 >= all_ * 9;
}

LogTicks LogTicks::at_messages(const std::vector<std::int64_t>& messages, std::int64_t start, double time_step,
                               std::int64_t shift, bool skips) {
  LogTicks ticks(start, time_step);
  ticks.is_nominal_ = false;
  ticks.skips_ = skips;
  constexpr double gain = 0.1;  // a single late message moves the phase by a tenth of its lateness
  double phase = 0.0;           // smoothed time of the last tick after the start [steps]
  const auto steps = [start, time_step](std::int64_t time) {
    return static_cast<double>(time - start) * 1e-9 / time_step;
  };
  for (auto message = std::ranges::lower_bound(messages, start); message != messages.end(); ++message) {
    if (ticks.messages_.empty()) {
      // The first commands may be missing; a tick is up to a quarter of a step too early if the messages jitter.
      const double missing = shift < 0 ? std::floor(steps(*message + shift) + 0.25) : 0.0;
      ticks.messages_.push_back({*message, static_cast<std::int64_t>(std::max(0.0, missing))});
      phase = steps(*message);
      continue;
    }
    std::int64_t passed = std::llround(steps(*message) - phase);
    // After a late message the next one comes early: two messages in two steps.
    if (message + 1 != messages.end())
      passed = std::min<std::int64_t>(passed, std::llround(steps(*(message + 1)) - phase) - 1);
    passed = std::max<std::int64_t>(1, passed);
    const std::int64_t ticks_passed = skips ? 1 : passed;
    phase += static_cast<double>(passed);
    phase += gain * (steps(*message) - phase);
    ticks.messages_.push_back({*message, ticks.messages_.back().tick + ticks_passed});
  }
  for (Message& message : ticks.messages_) message.time = std::max(message.time + shift, start);
  return ticks;
}

LogTicks LogTicks::at_regular_times(const RegularTimes& times, std::int64_t shift, std::int64_t start, std::int64_t end,
                                    double time_step) {
  LogTicks ticks(start, time_step);
  ticks.is_nominal_ = false;
  ticks.period_ = times.period;
  // Inputs: the message that is nearest to the start. Commands: the first one after it.
  const double early = shift >= 0 ? times.period / 2 : static_cast<double>(times.jitter);
  const double first = std::ceil((static_cast<double>(start - times.origin) - early) / times.period);
  const std::int64_t message = times.origin + std::llround(first * times.period);
  ticks.grid_start_ = message + shift;
  ticks.size_ = end < message ? 0 : 1 + std::llround(static_cast<double>(end - message) / times.period);
  return ticks;
}

RegularTimes regular_times(const std::vector<std::int64_t>& messages, double time_step) {
  RegularTimes times{messages.front(), time_step * 1e9, 0};
  if (messages.size() < 3) return times;
  // A loop that tracks phase and rate numbers the messages: the numbers continue where messages are missing.
  constexpr double phase_gain = 0.1, rate_gain = 0.002;
  double phase = 0.0, rate = 0.0, last = 0.0;  // relative to a grid of the time step [steps]
  std::vector<double> numbers, off;            // of each message; off: from that grid [ns]
  for (const std::int64_t time : messages) {
    const double since = static_cast<double>(time - messages.front());
    const double predicted = phase + rate * (since / times.period - last);
    const double number = std::round(since / times.period - predicted);
    const double deviation = since / times.period - number - predicted;
    phase = predicted + phase_gain * deviation;
    rate += rate_gain * deviation;
    last = since / times.period;
    numbers.push_back(number);
    off.push_back(since - number * times.period);
  }
  double slope = 0.0, offset = 0.0, limit = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 10; ++round) {
    double count = 0, n = 0, y = 0;
    const auto is_used = [&](std::size_t i) { return std::abs(off[i] - offset - slope * numbers[i]) <= limit; };
    for (std::size_t i = 0; i < off.size(); ++i)
      if (is_used(i)) ++count, n += numbers[i], y += off[i];
    n /= count, y /= count;
    double nn = 0, ny = 0;
    for (std::size_t i = 0; i < off.size(); ++i)
      if (is_used(i)) nn += (numbers[i] - n) * (numbers[i] - n), ny += (numbers[i] - n) * (off[i] - y);
    slope = nn > 0 ? ny / nn : 0.0;
    offset = y - slope * n;
    std::vector<double> residuals;
    for (std::size_t i = 0; i < off.size(); ++i) residuals.push_back(std::abs(off[i] - offset - slope * numbers[i]));
    const auto nine_of_ten = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() * 9 / 10);
    std::nth_element(residuals.begin(), nine_of_ten, residuals.end());
    times.jitter = std::llround(*nine_of_ten);
    limit = 2.0 * *nine_of_ten + 1.0;
  }
  times.origin += std::llround(offset);
  times.period += slope;
  return times;
}

std::int64_t LogTicks::grid_time(std::int64_t origin, std::int64_t ticks) const {
  if (ticks < 0) return origin - static_cast<std::int64_t>(nanoseconds_of(-ticks, step_));
  return origin + static_cast<std::int64_t>(nanoseconds_of(ticks, step_));
}

/// Few ticks have no message, so that a message's index in the list is hardly less than its tick's number.
std::vector<LogTicks::Message>::const_iterator LogTicks::message_from(std::int64_t tick) const {
  const auto last = static_cast<std::int64_t>(messages_.size()) - 1;
  auto to = messages_.begin() + std::clamp<std::int64_t>(tick - messages_.front().tick, 0, last);
  std::ptrdiff_t step = 1;
  for (; to - messages_.begin() >= step && (to - step)->tick >= tick; step *= 2) to -= step;
  return std::lower_bound(to - std::min(step, to - messages_.begin()), to, tick,
                          [](const Message& message, std::int64_t wanted) { return message.tick < wanted; });
}

std::int64_t LogTicks::time(std::int64_t tick) const {
  if (is_nominal_) return grid_time(start_, tick);
  const auto from_start = [&](std::int64_t regular) { return tick < 0 ? regular : std::max(regular, start_); };
  if (is_grid()) return from_start(grid_start_ + std::llround(static_cast<double>(tick) * period_));
  if (tick < messages_.front().tick)
    return from_start(grid_time(messages_.front().time, tick - messages_.front().tick));
  if (tick >= size()) return grid_time(messages_.back().time, tick - size() + 1);
  const auto message = message_from(tick);
  if (message->tick == tick) return message->time;
  const Message &before = *(message - 1), &after = *message;
  return before.time + (after.time - before.time) / (after.tick - before.tick) * (tick - before.tick);
}

std::int64_t LogTicks::nearest(std::int64_t wanted) const {
  if (is_nominal_) return std::llround(std::max(0.0, static_cast<double>(wanted - start_) * 1e-9) / step_);
  if (is_grid()) return std::llround(std::max(0.0, static_cast<double>(wanted - grid_start_)) / period_);
  std::int64_t from = 0, to = size() - 1;  // the last tick at or before `wanted`
  while (from < to) {
    const std::int64_t middle = from + (to - from + 1) / 2;
    time(middle) <= wanted ? from = middle : to = middle - 1;
  }
  return from + 1 < size() && time(from + 1) - wanted <= wanted - time(from) ? from + 1 : from;
}

bool LogTicks::has_message(std::int64_t tick) const {
  return is_grid() || tick < 0 || tick >= size() || message_from(tick)->tick == tick;
}

bool LogTicks::is_irregular(std::int64_t tick, double usual) const {
  if (is_grid() || tick <= 0) return false;
  const double longer = static_cast<double>(time(tick) - time(tick - 1)) * 1e-9 - step_;
  return (skips_ ? -longer : std::abs(longer)) > usual * step_;
}

}  // namespace rehearse
