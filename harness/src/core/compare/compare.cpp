#include <fmt/format.h>
#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/quiet_thread.h"
#include "channel_findings.h"
#include "compare_channel.h"
#include "compare_provenance.h"
#include "compare_structure.h"
#include "compare_variables.h"
#include "compared_files.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "divergence_text.h"
#include "series_rules.h"

namespace rehearse {

bool ChannelFindings::count(double difference, double tolerance, bool beyond) {
  ++result_.differing;
  if (beyond) ++result_.beyond;
  const double times = times_tolerance(difference, tolerance);
  // a difference of NaN (a number against NaN) fails these comparisons, so it is the worst
  const bool worse = !(times <= worst_times_) || (times == worst_times_ && !(difference <= worst_difference_));
  return worse || !result_.first_bit || (beyond && !result_.first);
}

void ChannelFindings::describe(const Divergence& divergence, bool beyond) {
  mark(divergence);
  if (beyond && (!result_.first || comes_before(divergence, *result_.first))) result_.first = divergence;
  const double times = times_tolerance(divergence.judged(), divergence.tolerance);
  if (times < worst_times_ || (times == worst_times_ && divergence.judged() <= worst_difference_)) return;
  const auto or_infinite = [](double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  };
  worst_times_ = or_infinite(times);
  worst_difference_ = or_infinite(divergence.judged());
  result_.worst = divergence;
}

void ChannelFindings::structure(const Divergence& divergence) {
  if (!result_.first || comes_before(divergence, *result_.first)) result_.first = divergence;
  mark(divergence);
}

void ChannelFindings::structure_before(const Divergence& divergence) {
  for (std::optional<Divergence>* place : {&result_.first, &result_.first_bit})
    if (!*place || !comes_before(**place, divergence)) *place = divergence;
}

void ChannelFindings::mark(const Divergence& divergence) {
  if (!result_.first_bit || comes_before(divergence, *result_.first_bit)) result_.first_bit = divergence;
}

namespace {

/// The order of cause and effect of the stages within one tick.
int rank_of(Stage stage) {
  switch (stage) {
    case Stage::physics: return 0;
    case Stage::sensors: return 1;
    case Stage::renderer: return 2;
    case Stage::inputs: return 3;
    case Stage::controller: return 4;
    case Stage::costs: return 5;
  }
  return 6;
}

}  // namespace

bool CompareOptions::takes(Stage stage) const {
  return stages.empty() || std::ranges::find(stages, stage) != stages.end();
}

bool comes_before(const Divergence& a, const Divergence& b) {
  if ((a.stage == Stage::costs) != (b.stage == Stage::costs)) return b.stage == Stage::costs;
  return a.tick != b.tick ? a.tick < b.tick : rank_of(a.stage) < rank_of(b.stage);
}

std::size_t column_of(const TraceChannel& channel, std::string_view element) {
  const auto found =
      std::ranges::find_if(channel.columns, [&](const TraceColumn& column) { return column.element == element; });
  return static_cast<std::size_t>(found - channel.columns.begin());
}

const std::string& series_of(const TraceChannel& channel, const TraceColumn& column) {
  return channel.type == msg::TFMessage::type_name ? column.element : column.series;
}

std::string_view series_of(const TraceChannel& channel) {
  const std::string_view topic = channel.topic;
  return topic.starts_with('/') ? topic.substr(1) : topic;
}

Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time) {
  const TickClock& clock =
      !traces.clock.has(time) && traces.actual_clock.has(time) ? traces.actual_clock : traces.clock;
  Divergence divergence;
  divergence.tick = clock.tick_at(time);
  if (!traces.have_ticks()) {  // no recording of Rehearse: the index of the message
    const auto message = std::lower_bound(channel.times.begin(), channel.times.end(), time);
    divergence.tick = static_cast<std::int64_t>(channel.earlier) + (message - channel.times.begin());
  }
  divergence.time = static_cast<double>(time) / 1e9;
  divergence.channel = channel.topic;
  divergence.stage = stage_of(channel.topic);
  return divergence;
}

namespace {

/// The number of ticks that both runs have. The message that closes a run contains the state after the last tick, and
/// is no tick itself.
std::int64_t compared_ticks(const ComparedTraces& traces) {
  std::int64_t messages = 0;
  for (std::size_t i = 0; i < traces.clock.size(); ++i) {
    const std::uint64_t time = traces.clock.time(i);
    if (time <= traces.end && traces.actual_clock.has(time)) ++messages;
  }
  std::int64_t recorded = messages;
  if (const auto outcome = RunFacts::of(traces.golden).outcome) recorded = outcome->ticks.value_or(messages);
  return std::min(messages, recorded);
}

Agreement agreement_of(const Comparison& comparison) {
  if (!comparison.within) return Agreement::beyond;
  if (comparison.equal) return Agreement::equal;
  const bool all_noise = comparison.differing > 0 && comparison.in_noise == comparison.differing;
  return all_noise ? Agreement::in_noise : Agreement::within;
}

/// Sums up the findings of all channels.
void conclude(Comparison& comparison, std::vector<ChannelComparison> channels) {
  const auto take = [](std::optional<Divergence>& best, const std::optional<Divergence>& other) {
    if (other && (!best || comes_before(*other, *best))) best = other;
  };
  std::optional<Divergence> lone;  // the first channel that only one run has
  std::set<std::string> differing;
  for (ChannelComparison& channel : channels) {
    comparison.values += channel.values;
    if (channel.of_events) comparison.events += channel.values;
    comparison.differing += channel.differing;
    comparison.in_noise += channel.in_noise;
    comparison.beyond += channel.beyond;
    comparison.blanked += channel.blanked;
    take(channel.is_lone ? lone : comparison.first, channel.first);
    if (!channel.is_lone) take(comparison.first_bit, channel.first_bit);
    if (channel.worst && (!comparison.worst || is_worse(*channel.worst, *comparison.worst)))
      comparison.worst = channel.worst;
    if (channel.first_bit) differing.insert(channel.channel);
  }
  for (const ChannelComparison& channel : channels)
    if (!channel.of_events && differing.insert(channel.channel).second)
      comparison.equal_channels.push_back(channel.channel);
  if (comparison.first && lone)
    for (const ChannelComparison& channel : channels)
      if (channel.is_lone)
        comparison.remarks.push_back(
            fmt::format("{}: {}", channel.group.empty() ? channel.channel : channel.group, channel.first->note));
  for (ChannelComparison& channel : channels)
    (channel.first_bit ? comparison.channels : comparison.same).push_back(std::move(channel));
  if (!comparison.first) comparison.first = lone;
  if (!comparison.first_bit) comparison.first_bit = lone;
  comparison.equal = !comparison.first_bit;
  comparison.within = !comparison.first;
  comparison.words_alone = comparison.within && !comparison.equal &&
                           std::ranges::all_of(comparison.channels, [](const ChannelComparison& channel) {
                             return channel.channel == run_topics::events;
                           });
  comparison.agreement = agreement_of(comparison);
  std::ranges::stable_sort(comparison.channels, [](const ChannelComparison& a, const ChannelComparison& b) {
    return a.is_lone != b.is_lone ? b.is_lone : comes_before(*a.first_bit, *b.first_bit);
  });
}

/// True if a compared stage makes some of the channel's values. Checkpoints are compared by the state's hash; a
/// comparison of some stages leaves them out.
bool takes(const CompareOptions& options, const TraceChannel& channel) {
  if (channel.type == msg::Tick::type_name) return true;  // decided for each element
  if (channel.type == msg::Checkpoint::type_name) return options.stages.empty();
  return options.takes(stage_of(channel.topic));
}

/// The result if nothing is compared, with the reason.
Comparison refusal(const Diagnostic& reason) {
  Comparison comparison;
  comparison.agreement = Agreement::beyond;
  Divergence& first = comparison.first.emplace();
  first.stage = Stage::inputs;
  first.note = fmt::format("{}: {}; {}", reason.file, reason.message, reason.hint);
  comparison.first_bit = comparison.first;
  return comparison;
}

/// The ends of the windows of two runs. A window ends before a tick, so that no tick is divided.
class WindowBorders {
 public:
  WindowBorders(const ComparedTraces& traces, std::uint64_t first, std::uint64_t last, std::size_t window_size)
      : traces_(traces), end_(last) {
    const double size = static_cast<double>(traces.golden_run.size + traces.actual_run.size);
    const double windows = std::max(1.0, size / static_cast<double>(window_size));
    step_ = static_cast<std::uint64_t>(static_cast<double>(last - first) / windows) + 1;
  }

  /// The end of the window that begins at this time, inclusive [ns].
  std::uint64_t after(std::uint64_t begin) const {
    if (end_ - begin <= step_) return end_;
    const TickClock& clock = traces_.clock.empty() ? traces_.actual_clock : traces_.clock;
    const auto tick = clock.next_time(begin + step_);
    return tick ? std::min(end_, *tick - 1) : begin + step_;
  }

 private:
  const ComparedTraces& traces_;
  const std::uint64_t end_;  // [ns]
  std::uint64_t step_ = 0;   // [ns]
};

}  // namespace

std::string_view to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::equal: return "equal";
    case Agreement::in_noise: return "in noise";
    case Agreement::within: return "within";
    case Agreement::beyond: return "beyond";
  }
  return "";
}

namespace {

/// Compares two runs, window after window.
class RunComparer {
 public:
  RunComparer(const RunSurvey& golden, const RunSurvey& actual, const std::vector<ToleranceRule>& rules,
              const CompareOptions& options);

  const ComparedTraces& traces() const { return traces_; }
  /// The channels that the windows have to contain.
  std::vector<PairedChannel> channels() const;
  /// No window will contain the messages before that second [ns], which are equal.
  void skip_to(std::uint64_t second);
  void take(const Window& window);
  Comparison finish();

 private:
  void find_undecoded(const std::function<bool(const TraceChannel&)>& taken);
  static ChannelComparison& add_to(std::vector<ChannelComparison>& results, const std::string& topic);

  ComparedTraces traces_;
  Comparison comparison_;
  std::vector<ChannelComparison> results_;
  std::vector<ChannelComparison> of_events_;  // after the values: of two findings in one tick, a value is reported
  std::deque<ChannelComparer> comparers_;     // in the golden's order
  std::optional<VariablesRemark> variables_;
};

ChannelComparison& RunComparer::add_to(std::vector<ChannelComparison>& results, const std::string& topic) {
  ChannelComparison& result = results.emplace_back();
  result.channel = topic;
  result.stage = stage_of(topic);
  return result;
}

RunComparer::RunComparer(const RunSurvey& golden, const RunSurvey& actual, const std::vector<ToleranceRule>& rules,
                         const CompareOptions& options)
    : traces_{golden, actual, rules, options} {
  if (options.until) traces_.end = static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9));
  const auto taken = [&](const TraceChannel& channel) {
    return takes(options, channel) && !isnt_compared(channel, rules);
  };
  const auto add = [&](const std::string& topic) -> ChannelComparison& { return add_to(results_, topic); };
  if (!traces_.clock.empty() && !traces_.actual_clock.empty()) compare_ticks(traces_, add(run_topics::tick));
  compare_events(
      traces_,
      [&](const std::string& topic) -> ChannelComparison& {
        ChannelComparison& result = add_to(of_events_, topic);
        result.of_events = true;
        return result;
      },
      comparison_.event_differences);
  comparison_.other_inputs = find_other_inputs(traces_);
  if (!comparison_.other_inputs.empty()) comparison_.remarks.push_back(other_inputs_sentence(comparison_.other_inputs));
  find_undecoded(taken);
  compare_lone_channels(traces_, taken, add, comparison_.not_compared);
  comparison_.remarks.insert(comparison_.remarks.end(), comparison_.not_compared.begin(),
                             comparison_.not_compared.end());
  for (const TraceChannel& channel : traces_.golden.channels()) {
    const TraceChannel* other = counterpart(traces_.golden, channel, traces_.actual);
    if (!taken(channel) || !other) continue;
    const bool differing_events = std::ranges::any_of(of_events_, [&](const ChannelComparison& events) {
      return events.channel == channel.topic && events.first_bit;
    });
    comparers_.emplace_back(traces_, PairedChannel{channel, *other, golden.of(channel), actual.of(*other)},
                            differing_events);
  }
  variables_.emplace(traces_);
}

/// Names the channels with messages that can't be decoded.
void RunComparer::find_undecoded(const std::function<bool(const TraceChannel&)>& taken) {
  for (const RunSurvey* run : {&traces_.golden_run, &traces_.actual_run}) {
    for (const TraceChannel& channel : run->whole().channels()) {
      const ChannelSurvey& survey = run->of(channel);
      if (survey.undecoded == 0 || !taken(channel)) continue;
      const bool one = survey.undecoded == 1;
      comparison_.undecoded.push_back(
          fmt::format("{}: {} message{} of the {} can't be decoded, {}at {:.16g} s ({}); {}", channel.topic,
                      survey.undecoded, one ? "" : "s", run == &traces_.golden_run ? "golden" : "run",
                      one ? "" : "the first ", static_cast<double>(survey.first_undecoded) / 1e9, survey.problem,
                      one ? "it is compared by its bytes" : "they are compared by their bytes"));
    }
  }
  comparison_.remarks.insert(comparison_.remarks.end(), comparison_.undecoded.begin(), comparison_.undecoded.end());
}

std::vector<PairedChannel> RunComparer::channels() const {
  std::vector<PairedChannel> channels = variables_->channels();
  for (const ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) channels.push_back(comparer.channel());
  return channels;
}

void RunComparer::skip_to(std::uint64_t second) {
  for (ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) comparer.take_equal(comparer.channel().golden_survey.messages_before(second));
}

void RunComparer::take(const Window& window) {
  for (ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) comparer.take(window);
  variables_->take(window);
}

Comparison RunComparer::finish() {
  for (ChannelComparer& comparer : comparers_) {
    const TraceChannel& channel = comparer.channel().golden;
    ChannelComparison result = comparer.finish();
    if (is_picture(channel)) comparison_.pictures += result.values;
    const bool by_hash = channel.type == msg::Checkpoint::type_name;  // not compared itself, so not reported as equal
    if (!by_hash || result.first_bit) results_.push_back(std::move(result));
  }
  if (std::string remark = variables_->text(); !remark.empty()) comparison_.remarks.push_back(std::move(remark));
  results_.insert(results_.end(), of_events_.begin(), of_events_.end());
  comparison_.ticks = compared_ticks(traces_);
  conclude(comparison_, std::move(results_));
  compare_provenance(traces_, comparison_);
  const Trace* compared[] = {&traces_.golden, &traces_.actual};
  comparison_.warnings = unmatched_rules(traces_.rules, compared);
  return std::move(comparison_);
}

}  // namespace

namespace {

/// The trace with only those messages of its state that the other run has, too; none: the trace itself.
Result<std::optional<Trace>> samples_of(const Trace& trace, const Trace& other) {
  const auto rate = RunFacts::of(other).state_rate;
  if (!rate || RunFacts::of(trace).state_rate == rate) return std::optional<Trace>();
  auto samples = REHEARSE_TRY(load_samples(trace.file(), *rate));
  return std::optional(std::move(samples));
}

Comparison compare_whole(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                         const CompareOptions& options) {
  WatchedLimits limits(golden, actual);
  RunSurvey golden_run(rules, std::move(limits.golden)), actual_run(rules, std::move(limits.actual));
  golden_run.take(golden);
  golden_run.finish(golden);
  actual_run.take(actual);
  actual_run.finish(actual);
  RunComparer comparer(golden_run, actual_run, rules, options);
  comparer.take({golden, actual, 0, comparer.traces().end});
  return comparer.finish();
}

}  // namespace

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options) {
  for (const Trace* trace : {&golden, &actual})
    if (const auto known = check_version(*trace); !known) return refusal(known.errors()[0]);
  const auto of_golden = samples_of(golden, actual), of_actual = samples_of(actual, golden);
  for (const auto* samples : {&of_golden, &of_actual})
    if (!*samples) return refusal(samples->errors()[0]);
  return compare_whole(*of_golden ? **of_golden : golden, *of_actual ? **of_actual : actual, rules, options);
}

namespace {

/// A recording that is read in pieces; `samples`: the rate of the other recording's state, if that contains only
/// samples of it.
struct SurveyedFile {
  SurveyedFile(const std::filesystem::path& file, const std::optional<StateRate>& samples,
               const std::vector<ToleranceRule>& rules, std::vector<WatchedLimit> limits, std::size_t piece_size,
               Trace::Damage damage, const Trace::OnPiece& on_piece = {})
      : survey(rules, std::move(limits)), whole(read(file, samples, piece_size, damage, on_piece)) {
    if (whole) survey.finish(*whole);
  }
  SurveyedFile(const SurveyedFile&) = delete;
  SurveyedFile& operator=(const SurveyedFile&) = delete;

  RunSurvey survey;
  const Result<Trace> whole;

 private:
  Result<Trace> read(const std::filesystem::path& file, const std::optional<StateRate>& samples, std::size_t piece_size,
                     Trace::Damage damage, const Trace::OnPiece& on_piece) {
    const auto take = [&](const Trace& piece) {
      survey.take(piece);
      if (on_piece) on_piece(piece);
    };
    return load_for_comparison(file, samples ? &*samples : nullptr, take, piece_size, damage);
  }
};

/// The largest lead and lag of all rules [ns].
std::pair<std::uint64_t, std::uint64_t> largest_lead_and_lag(const std::vector<ToleranceRule>& rules) {
  double lead = 0.0, lag = 0.0;
  for (const ToleranceRule& rule : rules) {
    lead = std::max(lead, rule.lead.value_or(0.0));
    lag = std::max(lag, rule.lag.value_or(0.0));
  }
  return {static_cast<std::uint64_t>(std::ceil(lead * 1e9)), static_cast<std::uint64_t>(std::ceil(lag * 1e9))};
}

/// The windows of some channels of a recording, from a second on [ns].
TraceWindows windows_from(std::uint64_t second, const RunSurvey& run,
                          const std::vector<const TraceChannel*>& channels) {
  std::vector<std::size_t> indices;
  WindowsStart start{second, {}};
  for (const TraceChannel* channel : channels) {
    indices.push_back(run.index_of(*channel));
    start.earlier.push_back(run.of(*channel).messages_before(second));
  }
  return {run.whole(), indices, start};
}

/// Reads the differing parts of two recordings once more, and compares them.
Result<void> compare_windows(RunComparer& comparer, std::size_t window_size, Trace::Damage damage) {
  const ComparedTraces& traces = comparer.traces();
  std::vector<const TraceChannel*> of_golden, of_actual;
  constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t first = never, last = 0, equal_until = never;
  for (const PairedChannel& channel : comparer.channels()) {
    of_golden.push_back(&channel.golden);
    of_actual.push_back(&channel.actual);
    first = std::min({first, channel.golden_survey.first_time, channel.actual_survey.first_time});
    last = std::max({last, channel.golden_survey.last_time, channel.actual_survey.last_time});
    equal_until = std::min(equal_until, rehearse::equal_until(channel.golden_survey, channel.actual_survey));
  }
  last = std::min(last, traces.end);
  if (first > last) return {};
  const auto [lead, lag] = largest_lead_and_lag(traces.rules);
  const WindowBorders borders(traces, first, last, window_size);
  equal_until = std::min(equal_until, second_of(last));
  comparer.skip_to(equal_until);
  std::uint64_t begin = std::max(first, equal_until);
  TraceWindows golden_windows =
      windows_from(second_of(equal_until - std::min(equal_until, lag)), traces.golden_run, of_golden);
  TraceWindows actual_windows = windows_from(equal_until, traces.actual_run, of_actual);
  for (std::uint64_t end = 0; begin <= last; begin = end + 1) {
    end = borders.after(begin);
    golden_windows.move(begin - std::min(begin, lag), end + lead);
    actual_windows.move(begin, end);
    comparer.take({golden_windows.window(), actual_windows.window(), begin, end});
  }
  if (damage == Trace::Damage::tolerate) return {};
  for (TraceWindows* windows : {&golden_windows, &actual_windows}) REHEARSE_TRY(windows->verdict());
  return {};
}

}  // namespace

Result<ComparedFiles> compare_files(const std::filesystem::path& golden, const std::filesystem::path& actual,
                                    const std::vector<ToleranceRule>& rules, const CompareOptions& options,
                                    const Trace::OnPiece& on_actual, std::size_t window_size, Trace::Damage damage) {
  const auto golden_outline = REHEARSE_TRY(Trace::outline(golden));
  const auto actual_outline = REHEARSE_TRY(Trace::outline(actual));
  for (const Trace* trace : {&golden_outline, &actual_outline})
    if (const auto known = check_version(*trace); !known)
      return ComparedFiles{refusal(known.errors()[0]), actual_outline};
  WatchedLimits limits(golden_outline, actual_outline);
  const auto of_golden = RunFacts::of(golden_outline).state_rate, of_actual = RunFacts::of(actual_outline).state_rate;
  std::optional<SurveyedFile> golden_file;
  std::thread reads_golden = start_quiet_thread(
      [&] { golden_file.emplace(golden, of_actual, rules, std::move(limits.golden), window_size, damage); });
  const SurveyedFile actual_file(actual, of_golden, rules, std::move(limits.actual), window_size, damage, on_actual);
  reads_golden.join();
  if (!golden_file->whole) return golden_file->whole.errors();
  if (!actual_file.whole) return actual_file.whole.errors();
  RunComparer comparer(golden_file->survey, actual_file.survey, rules, options);
  REHEARSE_TRY(compare_windows(comparer, window_size, damage));
  Comparison comparison = comparer.finish();
  return ComparedFiles{std::move(comparison), *actual_file.whole};
}

Result<Comparison> compare(const std::filesystem::path& golden, const std::filesystem::path& actual,
                           const std::vector<ToleranceRule>& rules, const CompareOptions& options,
                           std::size_t window_size) {
  auto compared = REHEARSE_TRY(compare_files(golden, actual, rules, options, {}, window_size));
  return std::move(compared.comparison);
}

Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace) {
  if (!trace.find_attachment("scenario.yaml")) return std::vector<ToleranceRule>();
  auto scenario = REHEARSE_TRY(recorded_scenario(trace));
  return scenario.tolerances;
}

}  // namespace rehearse
