// What the parts of a comparison share. Internal to compare*.cpp.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trace/channel_name.h"
#include "trace/run_facts.h"

namespace rehearse {

/// Which tick a time belongs to, by a trace's /tick channel.
class TickClock {
 public:
  TickClock() = default;
  explicit TickClock(const Trace& trace);
  /// Of a piece of a trace; `before` is that of the piece before it, whose last tick may not be over.
  TickClock(const Trace& piece, const TickClock& before);
  bool empty() const { return times_.empty(); }
  std::uint64_t last_time() const { return times_.back(); }
  const std::vector<std::uint64_t>& times() const { return times_; }  // [ns]
  /// Of the latest tick at or before the time; counts from 0 without ticks.
  std::int64_t tick_at(std::uint64_t time) const;
  /// Whether a tick begins at that time.
  bool has(std::uint64_t time) const;

 private:
  void read(const Trace& trace);

  std::vector<std::uint64_t> times_;  // ascending
  std::vector<std::int64_t> ticks_;
};

/// A span of time in which the numbers of a body are not judged; both ends are part of it [ns].
struct BlankedSpan {
  std::uint64_t from = 0;
  std::uint64_t until = 0;
};

/// Two traces and what decides how they are compared.
struct ComparedTraces {
  const Trace& golden;
  const Trace& actual;
  const std::vector<ToleranceRule>& rules;
  const CompareOptions& options;
  TickClock clock;  // of the golden
  TickClock actual_clock;
  /// The last time that is compared: both runs reached it [ns].
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();
  bool one_goes_on = false;   // beyond that time, where the other has but the state that closes it
  bool another_step = false;  // their clocks run at different speed: numbers of ticks mean nothing
  /// By the name of a body, in the order of time.
  std::map<std::string, std::vector<BlankedSpan>, std::less<>> blanked = {};

  /// A tick that only one of the runs has, or the end of one, is one finding: no message of it is another.
  bool in_a_lone_tick(std::uint64_t time) const {
    if (clock.empty() || actual_clock.empty()) return false;
    return clock.has(time) != actual_clock.has(time) || (one_goes_on && time == end);
  }
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

/// Collects the divergences of one channel: counts them, keeps the first and the worst.
class ChannelFindings {
 public:
  explicit ChannelFindings(ChannelComparison& result) : result_(result) {}
  /// Counts a value whose bits differ. True if it has to be described: it is the first, the first beyond, or the worst.
  bool count(double difference, double tolerance, bool beyond);
  /// The place of what was just counted.
  void describe(const Divergence& divergence, bool beyond);
  /// Something that isn't a matter of two values: missing, extra, of another kind. Fails the channel.
  void structure(const Divergence& divergence);
  /// Other bits, but nothing that passes or fails: a hash, or a value that isn't judged.
  void mark(const Divergence& divergence);
  ChannelComparison& result() { return result_; }

 private:
  ChannelComparison& result_;
  double worst_times_ = -1.0;
  double worst_difference_ = -1.0;
};

/// Order of causes: by tick, then by stage. Equal places keep the order in which they were found.
bool comes_before(const Divergence& a, const Divergence& b);

/// The column of that element, or columns.size().
std::size_t column_of(const TraceChannel& channel, std::string_view element);

/// The name by which rules know a column. A transform is named by its frame, like the pose of a link.
const std::string& series_of(const TraceChannel& channel, const TraceColumn& column);

/// The name by which rules know the messages of a channel that has no columns: its topic without the first slash.
std::string_view series_of(const TraceChannel& channel);

/// A divergence of that channel at that time, without values.
Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time);

/// What control() returned is compared as events.
bool is_result_of_control(const TraceChannel& channel, std::string_view element);

/// Two integers that aren't the same: what they are and how far apart. Beyond 2^53, where doubles have gaps, in words.
void put_integers(Divergence& divergence, CellKind kind, std::uint64_t expected, std::uint64_t actual);

void compare_numbers(const ComparedTraces& traces, const MatchedChannel& channel, ChannelFindings& findings);
/// What has no column in the tables of numbers.
void compare_rests(const ComparedTraces& traces, const MatchedChannel& channel, ChannelFindings& findings);
void compare_payloads(const ComparedTraces& traces, const MatchedChannel& channel, ChannelFindings& findings);
bool is_picture(const TraceChannel& channel);
/// Of a camera's colours or distances.
Tolerance picture_tolerance(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);

/// Makes an entry of the comparison's channels; what it returns holds until the next call.
using AddChannel = std::function<ChannelComparison&(const std::string& topic)>;

/// Sets traces.end. One run may be longer than the other: everything is compared up to the shorter one's end, and this
/// says so. And the ticks that only one of them has.
void compare_ticks(ComparedTraces& traces, ChannelComparison& result);
/// What only one trace has, one entry for each body, controller, device or channel. `takes` tells which are compared.
void compare_lone_channels(const ComparedTraces& traces, const std::function<bool(const TraceChannel&)>& takes,
                           const AddChannel& add, std::vector<std::string>& remarks);
/// Sequences of events. Sets traces.blanked.
void compare_events(ComparedTraces& traces, const AddChannel& add, std::vector<EventDifference>& differences);

/// A variable of a controller that no rule names, or commands that moved the world before a branch began.
bool isnt_compared(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);
/// That such variables aren't the same in both; empty: they are.
std::string remark_on_variables(const ComparedTraces& traces);

/// What the two were recorded of and with that isn't the same: changed_files, same_arithmetic, remarks, explanation.
void compare_provenance(const ComparedTraces& traces, Comparison& comparison);
/// Rules that match nothing in either trace.
Diagnostics unmatched_rules(const ComparedTraces& traces);

}  // namespace rehearse
