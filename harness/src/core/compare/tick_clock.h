// TickClock: the ticks that times belong to, from a trace's /tick channel. Internal.
#pragma once

#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rehearse {

/// The times of all ticks of a run. Ticks at equal distances take the same memory, independent of their number.
class TickClock {
 public:
  TickClock() = default;
  explicit TickClock(const Trace& trace);
  /// Adds the next piece of a run.
  void take(const Trace& piece);
  /// Sorts the ticks by time, if the pieces of a file contained them in a different order.
  void put_in_order();

  bool empty() const { return stretches_.empty(); }
  std::size_t size() const { return empty() ? 0 : stretches_.back().earlier + stretches_.back().count; }
  std::uint64_t first_time() const { return stretches_.front().time; }       // [ns]
  std::uint64_t last_time() const { return stretches_.back().last_time(); }  // [ns]
  /// The smallest distance of two consecutive ticks; 0 without two ticks [ns].
  std::uint64_t smallest_step() const;
  /// The time of a tick, by its index in the order of time [ns].
  std::uint64_t time(std::size_t index) const;
  /// The time of the first tick at or after a time [ns].
  std::optional<std::uint64_t> next_time(std::uint64_t time) const;
  /// The number of the latest tick at or before the time, or 0. Ticks without recorded numbers count from 0.
  std::int64_t tick_at(std::uint64_t time) const;
  /// True if a tick begins at this time.
  bool has(std::uint64_t time) const;

 private:
  /// Consecutive ticks at equal distances.
  struct Stretch {
    std::uint64_t time = 0;  // of the first [ns]
    std::int64_t tick = 0;   // the first
    std::size_t earlier = 0;
    std::size_t count = 1;
    std::uint64_t step = 0;  // [ns]; 0 if all its ticks have one time

    std::uint64_t last_time() const { return time + step * (count - 1); }
    /// The index of the latest tick at or before a time that isn't before the first.
    std::size_t index_at(std::uint64_t at) const;
  };

  void add(std::uint64_t time, std::int64_t tick);
  const Stretch* stretch_at(std::uint64_t time) const;

  std::vector<Stretch> stretches_;
  bool in_order_ = true;
};

}  // namespace rehearse
