// What the parts of a comparison share. Internal to compare*.cpp.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/tolerance.h>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// Which tick a time belongs to, by a trace's /tick channel.
class TickClock {
 public:
  explicit TickClock(const Trace& trace);
  bool empty() const { return times_.empty(); }
  std::uint64_t last_time() const { return times_.back(); }
  const std::vector<std::uint64_t>& times() const { return times_; }  // [ns]
  /// Of the latest tick at or before the time; counts from 0 without ticks.
  std::int64_t tick_at(std::uint64_t time) const;
  /// Whether a tick begins at that time.
  bool has(std::uint64_t time) const;

 private:
  std::vector<std::uint64_t> times_;  // ascending
  std::vector<std::int64_t> ticks_;
};

/// Two traces and what decides how they are compared.
struct ComparedTraces {
  const Trace& golden;
  const Trace& actual;
  const std::vector<ToleranceRule>& rules;
  const CompareOptions& options;
  TickClock clock;  // of the golden
  TickClock actual_clock;
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();  // the last time that is compared: both runs reached it [ns]
};

/// A channel of both traces, their messages matched by time.
struct MatchedChannel {
  const TraceChannel& golden;
  const TraceChannel& actual;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // of message numbers
  bool in_step = false;                                    // pairs are (0, 0), (1, 1), ... over all messages of both
  std::vector<std::size_t> missing;                        // messages of golden only
  std::vector<std::size_t> extra;                          // messages of actual only
};

/// Collects the divergences of one channel, in order of time: counts them, keeps the first and the worst.
class Findings {
 public:
  explicit Findings(ChannelComparison& result) : result_(result) {}
  /// Counts a value whose bits differ. True if it has to be described: it is the first, the first beyond, or the worst.
  bool count(double difference, double tolerance, bool beyond);
  /// The place of what was just counted.
  void describe(const Divergence& divergence, bool beyond);
  /// Something that isn't a matter of two values: missing, extra, of another kind. Fails the channel.
  void structure(const Divergence& divergence);
  /// A hash: other bits, but nothing that passes or fails.
  void mark(const Divergence& divergence);
  ChannelComparison& result() { return result_; }

 private:
  ChannelComparison& result_;
  double worst_times_ = -1.0;
  double worst_difference_ = -1.0;
};

/// How many times its tolerance a difference is; infinity where none is allowed.
double times_tolerance(double difference, double tolerance);

/// Order of causes: by tick, then by stage. Equal places keep the order in which they were found.
bool comes_before(const Divergence& a, const Divergence& b);

/// The unit that a channel's metadata states for an element; empty if none.
std::string unit_of(const TraceChannel& channel, const std::string& element);

/// A divergence of that channel at that time, without values.
Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time);

void compare_numbers(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings);
void compare_payloads(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings);
bool is_picture(const TraceChannel& channel);

}  // namespace rehearse
