#include "tick_clock.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "series_rules.h"

namespace rehearse {

TickClock::TickClock(const Trace& trace) { take(trace); }

std::size_t TickClock::Stretch::index_at(std::uint64_t at) const {
  return step == 0 ? count - 1 : std::min<std::size_t>((at - time) / step, count - 1);
}

void TickClock::add(std::uint64_t time, std::int64_t tick) {
  if (!empty()) {
    Stretch& last = stretches_.back();
    const bool follows = time >= last.last_time();
    in_order_ = in_order_ && follows;
    const std::uint64_t step = time - last.last_time();
    const bool is_next = follows && tick == last.tick + static_cast<std::int64_t>(last.count);
    if (is_next && (last.count == 1 || step == last.step)) {
      last.step = step;
      ++last.count;
      return;
    }
  }
  stretches_.push_back({time, tick, size()});
}

void TickClock::take(const Trace& piece) {
  for (const TraceChannel& channel : piece.channels()) {
    if (channel.type != msg::Tick::type_name || channel.columns.empty()) continue;
    const std::size_t column = column_of(channel, "tick");
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      add(channel.times[row], column < channel.columns.size() ? static_cast<std::int64_t>(channel.bits(row, column))
                                                              : static_cast<std::int64_t>(channel.earlier + row));
    }
    break;
  }
}

void TickClock::put_in_order() {
  if (in_order_) return;
  std::vector<std::pair<std::uint64_t, std::int64_t>> ticks;
  ticks.reserve(size());
  for (const Stretch& stretch : std::exchange(stretches_, {}))
    for (std::size_t i = 0; i < stretch.count; ++i)
      ticks.emplace_back(stretch.time + i * stretch.step, stretch.tick + static_cast<std::int64_t>(i));
  std::ranges::stable_sort(ticks, {}, [](const auto& tick) { return tick.first; });
  in_order_ = true;
  for (const auto& [time, tick] : ticks) add(time, tick);
}

/// The latest stretch that begins at or before a time; null: there is none.
const TickClock::Stretch* TickClock::stretch_at(std::uint64_t time) const {
  const auto after = std::ranges::upper_bound(stretches_, time, {}, &Stretch::time);
  return after == stretches_.begin() ? nullptr : &*std::prev(after);
}

std::uint64_t TickClock::smallest_step() const {
  std::uint64_t smallest = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    if (stretches_[i].count > 1) smallest = std::min(smallest, stretches_[i].step);
    if (i > 0) smallest = std::min(smallest, stretches_[i].time - stretches_[i - 1].last_time());
  }
  return size() < 2 ? 0 : smallest;
}

std::uint64_t TickClock::time(std::size_t index) const {
  const Stretch& stretch = *std::prev(std::ranges::upper_bound(stretches_, index, {}, &Stretch::earlier));
  return stretch.time + stretch.step * (index - stretch.earlier);
}

std::optional<std::uint64_t> TickClock::next_time(std::uint64_t at) const {
  if (empty() || at > last_time()) return std::nullopt;
  if (has(at)) return at;
  const Stretch* stretch = stretch_at(at);
  return time(stretch ? stretch->earlier + stretch->index_at(at) + 1 : 0);
}

std::int64_t TickClock::tick_at(std::uint64_t time) const {
  const Stretch* stretch = stretch_at(time);
  return stretch ? stretch->tick + static_cast<std::int64_t>(stretch->index_at(time)) : 0;
}

bool TickClock::has(std::uint64_t time) const {
  const Stretch* stretch = stretch_at(time);
  return stretch && stretch->time + stretch->step * stretch->index_at(time) == time;
}

}  // namespace rehearse
