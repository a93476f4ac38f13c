// Declarations that the parts of a comparison share. Other rooms use some of them. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/trace/channel_name.h"
#include "core/trace/run_facts.h"
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
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // of message numbers
  std::vector<std::size_t> missing;                        // messages of golden only
  std::vector<std::size_t> extra;                          // messages of actual only

  /// Index of the channel in the golden.
  std::size_t place() const { return static_cast<std::size_t>(&golden - window.golden.channels().data()); }
};

/// Collects the divergences of one channel: counts them, keeps the first and the worst.
class ChannelFindings {
 public:
  explicit ChannelFindings(ChannelComparison& result) : result_(result) {}
  /// Counts a value whose bits differ. True if it has to be described: it is the first, the first beyond, or the worst.
  bool count(double difference, double tolerance, bool beyond);
  /// Stores the description of the value that was counted last.
  void describe(const Divergence& divergence, bool beyond);
  /// Stores a difference other than of two values: missing, extra, of a different kind. Fails the channel.
  void structure(const Divergence& divergence);
  /// Like structure(), for a difference that precedes all others of the same tick and stage.
  void structure_before(const Divergence& divergence);
  /// Stores a difference of bits that fails nothing: of a hash, or of a value that isn't judged.
  void mark(const Divergence& divergence);
  ChannelComparison& result() { return result_; }

 private:
  ChannelComparison& result_;
  double worst_times_ = -1.0;
  double worst_difference_ = -1.0;
};

/// A divergence in words: the text of its place ("tick 3 (0.003 s)"), then channel, element, expected and actual.
/// `with_stage`: false for files without ticks, where the stage has no meaning.
std::string describe(const Divergence& divergence, const std::string& place, bool with_stage);

/// Order of causes: by tick, then by stage. Equal places keep the order in which they were found.
bool comes_before(const Divergence& a, const Divergence& b);

/// The index of the element's column, or columns.size().
std::size_t column_of(const TraceChannel& channel, std::string_view element);

/// The name of a column in tolerance rules. A transform is named by its frame, like the pose of a link.
const std::string& series_of(const TraceChannel& channel, const TraceColumn& column);

/// The tolerance of a column by the rules and its unit; none for integers, which are exact.
Tolerance column_tolerance(const TraceChannel& channel, std::size_t column, const std::vector<ToleranceRule>& rules);

/// The name in tolerance rules for a channel without columns: its topic without the first slash.
std::string_view series_of(const TraceChannel& channel);

/// The channel of `other` that is compared with `channel`, which is one of `of`: the one with its topic; null if there
/// is none. Of several channels with this topic, the first is paired with the first, the second with the second.
const TraceChannel* counterpart(const Trace& of, const TraceChannel& channel, const Trace& other);

/// A divergence without values, at a time on this channel or on a window's table of it.
Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time);

/// True for the results of control(), which are compared as events.
bool is_result_of_control(const TraceChannel& channel, std::string_view element);

/// Sets the values of two different cells, and their difference. Integers beyond 2^53, where doubles have gaps, are
/// also stated in the note.
void put_cells(Divergence& divergence, CellKind kind, std::uint64_t expected, std::uint64_t actual);
std::uint64_t distance_of_integers(CellKind kind, std::uint64_t a, std::uint64_t b);
/// The difference that put_numbers() writes: 0 for two NaN.
double difference_between(double expected, double actual);

/// Judges some values of a channel's messages, window after window.
class PartJudge {
 public:
  virtual ~PartJudge() = default;
  virtual void take(const MatchedChannel& window) = 0;
  /// Counts pairs of messages that are equal.
  virtual void take_equal(std::int64_t /*pairs*/) {}
  virtual void finish() {}
};

std::unique_ptr<PartJudge> judge_numbers(const ComparedTraces& traces, const PairedChannel& channel,
                                         ChannelFindings& findings);
/// Judges the values without a column in the tables of numbers.
std::unique_ptr<PartJudge> judge_rests(const ComparedTraces& traces, const PairedChannel& channel,
                                       ChannelFindings& findings);
std::unique_ptr<PartJudge> judge_payloads(const ComparedTraces& traces, const PairedChannel& channel,
                                          ChannelFindings& findings);
bool is_picture(const TraceChannel& channel);
/// The tolerance of a camera's colours or distances.
Tolerance picture_tolerance(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);

/// Makes an entry of the comparison's channels. The returned reference is valid until the next call.
using AddChannel = std::function<ChannelComparison&(const std::string& topic)>;

/// Sets traces.end: everything is compared up to the end of the shorter run. Reports runs of different length, and
/// ticks that only one of them has.
void compare_ticks(ComparedTraces& traces, ChannelComparison& result);
/// Sets traces.other_inputs, and returns their names as Comparison::other_inputs has them.
std::vector<std::string> find_other_inputs(ComparedTraces& traces);
/// "the controller reads other inputs: + KNEE/dq of SR1/Walker"
std::string other_inputs_sentence(const std::vector<std::string>& names);
/// Reports the channels that only one trace has, with one entry for each body, controller, device or channel. `takes`:
/// true for channels that are compared.
void compare_lone_channels(const ComparedTraces& traces, const std::function<bool(const TraceChannel&)>& takes,
                           const AddChannel& add, std::vector<std::string>& remarks);
/// Compares the sequences of events, and sets traces.blanked.
void compare_events(ComparedTraces& traces, const AddChannel& add, std::vector<EventDifference>& differences);

/// True if a rule names this variable of a controller, "SR1/Walker/variable/phase", by a pattern with "/variable/" in
/// it. Variables are internals of a controller: only then they affect a verdict.
bool asks_for_variable(std::string_view series, const std::vector<ToleranceRule>& rules);
/// True for a variable of a controller that no rule names, and for commands that moved the world before a branch began.
bool isnt_compared(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);
/// Finds differences of the variables that no rule names.
class VariablesRemark {
 public:
  explicit VariablesRemark(const ComparedTraces& traces);
  /// The channels that the windows have to contain.
  const std::vector<PairedChannel>& channels() const { return channels_; }
  void take(const Window& window);
  /// The remark; empty if all are equal.
  std::string text() const;

 private:
  struct Found {
    std::uint64_t time;
    std::size_t order;  // of the channels
    std::string text;
  };
  void find_lone(const Trace& of, const RunSurvey& run, const Trace& other, const char* which);

  const ComparedTraces& traces_;
  std::vector<PairedChannel> channels_;             // channels that may differ
  std::vector<std::optional<std::size_t>> orders_;  // by index in channels_; none: it differs
  std::vector<Found> found_;
};

/// Compares the provenance of both traces: sets changed_files, same_arithmetic, same_origin, remarks and explanation.
void compare_provenance(const ComparedTraces& traces, Comparison& comparison);
/// The warning of a rule that matches nothing.
Diagnostic applies_to_nothing(const ToleranceRule& rule);
/// The warnings of the rules that match nothing in any of the traces.
Diagnostics unmatched_rules(const std::vector<ToleranceRule>& rules, std::span<const Trace* const> traces);

}  // namespace rehearse
