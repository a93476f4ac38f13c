#include "log_ticks.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "model/clock.h"

namespace rehearse {
namespace {

constexpr int bins_per_octave = 64;  // 32 of them are used, except below 64 ns

int bin_of(std::int64_t duration) {
  const auto number = static_cast<std::uint64_t>(duration);
  const int shift = std::max(0, static_cast<int>(std::bit_width(number)) - 6);
  return shift * bins_per_octave + static_cast<int>(number >> shift);
}

}  // namespace

void DurationCounts::add(std::int64_t duration) {
  Bin& bin = bins_[bin_of(duration)];
  ++bin.count;
  bin.sum += static_cast<double>(duration);
  ++all_;
}

std::int64_t DurationCounts::median() const {
  std::int64_t before = 0;
  for (const auto& [number, bin] : bins_)
    if ((before += bin.count) * 2 >= all_) return std::llround(bin.sum / static_cast<double>(bin.count));
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

LogTicks LogTicks::at_messages(const std::vector<std::int64_t>& messages, std::int64_t start, double time_step) {
  LogTicks ticks(start, time_step);
  constexpr double gain = 0.1;  // a single late message moves the phase by a tenth of its lateness
  double phase = 0.0;           // smoothed time of the last tick after the start [steps]
  const auto steps = [start, time_step](std::int64_t time) {
    return static_cast<double>(time - start) * 1e-9 / time_step;
  };
  for (auto message = std::lower_bound(messages.begin(), messages.end(), start); message != messages.end(); ++message) {
    if (ticks.is_grid()) {
      ticks.messages_.push_back({*message, 0});
      phase = steps(*message);
      continue;
    }
    std::int64_t passed = std::llround(steps(*message) - phase);
    // After a late message the next one comes early: two messages in two steps.
    if (message + 1 != messages.end())
      passed = std::min<std::int64_t>(passed, std::llround(steps(*(message + 1)) - phase) - 1);
    passed = std::max<std::int64_t>(1, passed);
    phase += static_cast<double>(passed);
    phase += gain * (steps(*message) - phase);
    ticks.messages_.push_back({*message, ticks.messages_.back().tick + passed});
  }
  return ticks;
}

std::int64_t LogTicks::grid_time(std::int64_t origin, std::int64_t ticks) const {
  if (ticks < 0) return origin - static_cast<std::int64_t>(nanoseconds_of(-ticks, step_));
  return origin + static_cast<std::int64_t>(nanoseconds_of(ticks, step_));
}

std::vector<LogTicks::Message>::const_iterator LogTicks::message_from(std::int64_t tick) const {
  return std::lower_bound(messages_.begin(), messages_.end(), tick,
                          [](const Message& message, std::int64_t wanted) { return message.tick < wanted; });
}

std::int64_t LogTicks::time(std::int64_t tick) const {
  if (is_grid()) return grid_time(start_, tick);
  if (tick < 0) return grid_time(messages_.front().time, tick);
  if (tick >= size()) return grid_time(messages_.back().time, tick - size() + 1);
  const auto message = message_from(tick);
  if (message->tick == tick) return message->time;
  const Message &before = *(message - 1), &after = *message;
  return before.time + (after.time - before.time) / (after.tick - before.tick) * (tick - before.tick);
}

std::int64_t LogTicks::nearest(std::int64_t wanted) const {
  if (is_grid()) return std::llround(std::max(0.0, static_cast<double>(wanted - start_) * 1e-9) / step_);
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

bool LogTicks::is_irregular(std::int64_t tick) const {
  constexpr double usual = 0.2;  // [time steps]: two messages that are each off by a tenth of a step are within it
  if (is_grid() || tick <= 0) return false;
  return std::abs(static_cast<double>(time(tick) - time(tick - 1)) * 1e-9 - step_) > usual * step_;
}

}  // namespace rehearse
