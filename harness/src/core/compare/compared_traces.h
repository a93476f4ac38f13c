// Two runs in a comparison: their channels, and their messages in windows of time. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "number_judge.h"
#include "run_survey.h"

namespace rehearse {

/// The inputs that a controller reads in one of two runs only. It may command the same, so they are no differences; but
/// the hashes of all inputs aren't comparable then.
struct OtherInputs {
  std::set<std::string> topics;
  std::set<std::pair<std::string, std::string>> values;  // of joints: topic and element
  bool devices = false;                                  // it reads other devices

  bool any() const { return devices || !topics.empty() || !values.empty(); }
};

/// Two runs, and the rules and options of their comparison.
struct ComparedTraces {
  const RunSurvey& golden_run;
  const RunSurvey& actual_run;
  const std::vector<ToleranceRule>& rules;
  const CompareOptions& options;
  // of the surveys; their tables have rows only if the whole traces are in memory
  const Trace& golden = golden_run.whole();
  const Trace& actual = actual_run.whole();
  const TickClock& clock = golden_run.clock;
  const TickClock& actual_clock = actual_run.clock;
  /// The last time that is compared: both runs reached it [ns].
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();
  bool one_goes_on = false;   // after `end`, where the other run has only its closing state
  bool another_step = false;  // the time steps differ: numbers of ticks aren't comparable
  OtherInputs other_inputs = {};
  /// The spans without judgement by the name of a body, in the order of time.
  std::map<std::string, std::vector<BlankedSpan>, std::less<>> blanked = {};

  /// False for files of other programs.
  bool have_ticks() const { return !clock.empty() || !actual_clock.empty(); }
  /// True if only one run has a tick at this time, or if one run ends there. This is one finding of its own, so the
  /// messages of the tick are no findings.
  bool in_a_lone_tick(std::uint64_t time) const {
    if (clock.empty() || actual_clock.empty()) return false;
    return clock.has(time) != actual_clock.has(time) || (one_goes_on && time == end);
  }
};

/// A channel of both runs, with its surveys.
struct PairedChannel {
  const TraceChannel& golden;
  const TraceChannel& actual;
  const ChannelSurvey& golden_survey;
  const ChannelSurvey& actual_survey;

  /// True if all messages and their times are equal.
  bool is_equal() const { return golden_survey == actual_survey; }
};

/// A span of time of both runs; the golden's tables may reach beyond it for tolerances that allow for time.
struct Window {
  const Trace& golden;
  const Trace& actual;
  std::uint64_t begin = 0;  // [ns]
  std::uint64_t end = 0;    // inclusive

  /// The messages of a channel in this window: the first, and one past the last.
  std::pair<std::size_t, std::size_t> messages(const TraceChannel& channel) const;
};

/// The table in a window for a channel of the whole trace.
const TraceChannel& table_in(const Trace& window, const Trace& whole, const TraceChannel& channel);

/// A channel of both runs in a window, its messages matched by time.
struct MatchedChannel {
  const Window& window;
  const TraceChannel& golden;
  const TraceChannel& actual;
  std::vector<std::pair<std::size_t, std::size_t>> pairs = {};      // of message numbers
  std::vector<std::pair<std::size_t, std::size_t>> undecoded = {};  // likewise, if one can't be decoded
  std::vector<std::size_t> missing = {};                            // messages of golden only
  std::vector<std::size_t> extra = {};                              // messages of actual only

  /// Index of the channel in the golden.
  std::size_t place() const { return static_cast<std::size_t>(&golden - window.golden.channels().data()); }
};

/// The channel of `other` that is compared with `channel`, which is one of `of`: the one with its topic; null if there
/// is none. Of several channels with this topic, the first is paired with the first, the second with the second.
const TraceChannel* counterpart(const Trace& of, const TraceChannel& channel, const Trace& other);

/// A divergence without values, at a time on this channel or on a window's table of it.
Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time);

/// Makes an entry of the comparison's channels. The returned reference is valid until the next call.
using AddChannel = std::function<ChannelComparison&(const std::string& topic)>;

}  // namespace rehearse
