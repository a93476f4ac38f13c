// TickClock: which tick a time belongs to, by a trace's /tick channel. Internal.
#pragma once

#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rehearse {

/// The times of all ticks of a run. Ticks at equal distances take the same memory, however many they are.
class TickClock {
 public:
  TickClock() = default;
  explicit TickClock(const Trace& trace);
  /// Adds the next piece of a run.
  void take(const Trace& piece);
  /// Sorts by time what the pieces of a file had in another order.
  void put_in_order();

  bool empty() const { return stretches_.empty(); }
  std::size_t size() const { return empty() ? 0 : stretches_.back().earlier + stretches_.back().count; }
  std::uint64_t first_time() const { return stretches_.front().time; }       // [ns]
  std::uint64_t last_time() const { return stretches_.back().last_time(); }  // [ns]
  /// Of a tick, by its place in the order of time [ns].
  std::uint64_t time(std::size_t index) const;
  /// Of the first tick at or after a time [ns].
  std::optional<std::uint64_t> next_time(std::uint64_t time) const;
  /// Of the latest tick at or before the time; counts from 0 without ticks.
  std::int64_t tick_at(std::uint64_t time) const;
  /// Whether a tick begins at that time.
  bool has(std::uint64_t time) const;

 private:
  /// Consecutive ticks at equal distances.
  struct Stretch {
    std::uint64_t time = 0;  // of the first [ns]
    std::int64_t tick = 0;   // the first
    std::size_t earlier = 0;
    std::size_t count = 1;
    std::uint64_t step = 0;  // [ns]; 0 if it has but one time

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
