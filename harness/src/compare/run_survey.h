// RunSurvey: what a comparison has to know of a whole run before it judges a part of it. One pass over the run finds
// it. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "event_sequences.h"

namespace rehearse {

/// Which tick a time belongs to, by a trace's /tick channel.
class TickClock {
 public:
  TickClock() = default;
  explicit TickClock(const Trace& trace);
  /// Adds the next piece of a run.
  void take(const Trace& piece);
  /// Sorts by time what the pieces of a file had in another order.
  void put_in_order();
  bool empty() const { return times_.empty(); }
  std::uint64_t last_time() const { return times_.back(); }
  const std::vector<std::uint64_t>& times() const { return times_; }  // [ns]
  /// Of the latest tick at or before the time; counts from 0 without ticks.
  std::int64_t tick_at(std::uint64_t time) const;
  /// Whether a tick begins at that time.
  bool has(std::uint64_t time) const;

 private:
  void add(std::uint64_t time, std::int64_t tick);
  std::int64_t tick_of(std::size_t index) const;
  void list_ticks();

  std::vector<std::uint64_t> times_;  // ascending
  std::int64_t first_tick_ = 0;
  std::vector<std::int64_t> ticks_;  // empty: consecutive, from the first on
};

/// All messages of a channel.
struct ChannelSurvey {
  std::uint64_t messages = 0;
  std::uint64_t first_time = std::numeric_limits<std::uint64_t>::max();  // [ns]
  std::uint64_t last_time = 0;                                           // [ns]
  std::uint64_t times_hash = 0;
  std::uint64_t hash = 0;  // of times and bytes

  bool operator==(const ChannelSurvey&) const = default;
};

struct RunSurvey {
  /// Of a run without messages; take() adds them. `rules` must outlive this.
  RunSurvey(const std::vector<ToleranceRule>& rules, std::vector<WatchedLimit> limits)
      : edges(std::move(limits)), rules_(&rules) {}

  void take(const Trace& piece);
  /// `whole` has all channels and columns, events and changes of contact, and must outlive this.
  void finish(const Trace& whole);

  const Trace& whole() const { return *whole_; }
  /// Of one of whole().channels().
  std::size_t index_of(const TraceChannel& channel) const;
  const ChannelSurvey& of(const TraceChannel& channel) const;
  /// The scale of a column, if it is judged by a relative tolerance; else 0.
  double scale_of(const TraceChannel& channel, std::size_t column) const;

  TickClock clock;
  EdgeFinder edges;
  std::size_t size = 0;  // of all numbers [bytes], about

 private:
  struct Scale {
    bool matters = false;
    double largest = 0.0;
  };
  void take_scales(const TraceChannel& channel, std::vector<Scale>& scales) const;

  const std::vector<ToleranceRule>* rules_;
  const Trace* whole_ = nullptr;
  std::vector<ChannelSurvey> channels_;     // like whole().channels()
  std::vector<std::vector<Scale>> scales_;  // by channel, then column
};

}  // namespace rehearse
