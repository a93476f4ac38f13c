// Makes a report in the order of its steps.
#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <memory>

#include "core/compare/compared_traces.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "core/mcap/glob.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/filter.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "report_findings.h"
#include "report_messages.h"
#include "report_page.h"
#include "report_pictures.h"
#include "report_robots.h"
#include "report_run.h"
#include "report_series.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_spans = 1000;

/// A trace, or the requested part of it, which is a temporary file meanwhile.
class SourceTrace {
 public:
  static Result<SourceTrace> load(const fs::path& file, const fs::path& scratch, const ReportOptions& options);
  ~SourceTrace() {
    std::error_code ignored;
    if (!scratch_.empty()) fs::remove(scratch_, ignored);
  }
  SourceTrace(SourceTrace&& other) noexcept
      : trace_(std::move(other.trace_)), scratch_(std::exchange(other.scratch_, fs::path())) {}
  SourceTrace& operator=(SourceTrace&&) = delete;

  const Trace& trace() const { return *trace_; }

 private:
  explicit SourceTrace(fs::path scratch) : scratch_(std::move(scratch)) {}

  std::unique_ptr<Trace> trace_;
  fs::path scratch_;  // empty: there is none
};

mcap::TimeBound moment_of(double seconds) {
  return {static_cast<std::uint64_t>(std::llround(std::max(0.0, seconds) * 1e9)), mcap::TimeOrigin::beginning};
}

Result<SourceTrace> SourceTrace::load(const fs::path& file, const fs::path& scratch, const ReportOptions& options) {
  const bool is_part = options.from || options.until;
  SourceTrace source(is_part ? scratch : fs::path());
  if (is_part) {
    mcap::FilterOptions part;
    if (options.from) part.selection.from = moment_of(*options.from);
    if (options.until) part.selection.until = moment_of(*options.until);
    const auto filtered = mcap::filter(file, scratch, part);
    if (!filtered) return filtered.errors();
  }
  auto trace = load_without_events(is_part ? scratch : file, Trace::Damage::tolerate);
  if (!trace) return trace.errors();
  if (const auto known = check_version(*trace); !known) return known.errors();
  if (!RunFacts::of(*trace).provenance)
    return error_in(file.string(), "it is an MCAP file, but not a recording of Rehearse: it has no provenance",
                    "rehearse replay turns a robot's log into one");
  source.trace_ = std::make_unique<Trace>(*std::move(trace));
  return source;
}

/// A span [begin, end) of ticks; for a run without ticks both are 0.
struct TickRange {
  std::int64_t begin = 0, end = 0;

  void take(const TickClock& clock) {
    if (clock.empty()) return;
    const std::int64_t first = clock.tick_at(clock.first_time()), last = clock.tick_at(clock.last_time());
    begin = begin == end ? first : std::min(begin, first);
    end = std::max(end, last + 1);
  }
};

/// A sentence about the end of a run; empty: it ended regularly.
std::string outcome_of(const RunFacts& run) {
  return run.outcome ? run.outcome->failure.value_or("") : "the recording was cut: it lacks the end of the run";
}

ReportJson json_of(const CallStack& stack) {
  ReportJson frames = ReportJson::array();
  for (const StackFrame& frame : stack.frames)
    frames.push_back({{"function", frame.function},
                      {"file", frame.file},
                      {"line", frame.line},
                      {"begin", frame.begin},
                      {"source", frame.source}});
  return {{"controller", stack.controller},
          {"command", stack.command},
          {"tick", stack.tick},
          {"frames", std::move(frames)}};
}

ReportJson run_json(const ReportedRun& run, std::string_view role, const fs::path& file) {
  const Trace& trace = run.trace;
  const RunFacts stated = RunFacts::of(trace);
  ReportJson provenance = ReportJson::object();
  if (stated.provenance)
    for (const auto& [key, value] : *stated.provenance) provenance[key] = value;
  const mcap::Attachment* scenario = trace.find_attachment("scenario.yaml");
  ReportJson remarks = ReportJson::array();
  for (const Diagnostic& damage : trace.damage()) remarks.push_back(damage.message);
  return {
      {"role", role},
      {"file", file.filename().string()},
      {"ticks", stated.ticks(trace.ticks())},
      {"complete", stated.outcome && !stated.outcome->failure},
      {"outcome", outcome_of(stated)},
      {"facts", std::move(provenance)},
      {"scenario", scenario ? std::string(reinterpret_cast<const char*>(scenario->data.data()), scenario->data.size())
                            : std::string()},
      {"remarks", std::move(remarks)}};
}

/// The time step [s]; for a recording whose scenario can't be read, by its clock.
double time_step_of(const ReportedRun& run, const std::optional<Scenario>& scenario) {
  if (scenario) return scenario->time_step;
  constexpr double usual = 0.001;
  const std::uint64_t step = run.clock.size() < 2 ? 0 : run.clock.time(1) - run.clock.first_time();  // [ns]
  return step == 0 ? usual : static_cast<double>(step) / 1e9;
}

/// Writes one report.
class ReportMaker {
 public:
  ReportMaker(const ReportOptions& options, ReportFile& file, const Trace& actual, const Trace* golden)
      : options_(options),
        file_(file),
        blobs_([&file](const std::string& id, ByteSpan coded) { file.put_blob(id, coded); }),
        actual_(actual) {
    if (golden) golden_.emplace(*golden);
  }

  Result<ReportSummary> make(const fs::path& actual_file, const fs::path& golden_file);

 private:
  const ReportedRun* golden() const { return golden_ ? &*golden_ : nullptr; }
  void judge();
  void judge_expectations(const fs::path& file);
  void conclude();
  ReportJson verdict_json() const;
  void write_channels(ReportJson& object);
  void write_happenings(ReportJson& object);
  bool is_wanted(const TraceChannel& channel) const;
  void omit_damage();
  void request_call_stack(const Places& places);
  ReportJson call_stack_json();

  const ReportOptions& options_;
  ReportFile& file_;
  BlobWriter blobs_;
  ReportedRun actual_;
  std::optional<ReportedRun> golden_;
  std::optional<Scenario> scenario_, golden_scenario_;  // none: it can't be read
  std::optional<Comparison> comparison_;
  std::optional<JudgedValues> judged_;
  std::vector<ExpectationResult> expectations_;  // of the run
  std::future<Result<CallStack>> call_stack_;    // while the series are written, as a debugger takes seconds
  ReportSummary summary_;
};

/// Compares both recordings as `diff` does. That finds the ticks and values to mark, also if the findings are given.
void ReportMaker::judge() {
  if (!golden_) return;
  std::vector<ToleranceRule> rules;
  if (options_.tolerances)
    rules = *options_.tolerances;
  else if (golden_scenario_)
    rules = golden_scenario_->tolerances;
  judged_.emplace(*golden_);
  CompareOptions how;
  how.until = options_.horizon;
  how.on_difference = [this](const DifferingValue& value) { judged_->take(value); };
  comparison_ = compare(golden_->trace, actual_.trace, rules, how);
  if (options_.comparison) comparison_ = options_.comparison;
  judged_->conclude(*comparison_);
}

/// The sentence without the violations at its beginning or end, which the page lists.
std::string besides_violations(std::string sentence, const std::vector<ExpectationResult>& expectations) {
  const std::string violated = verdict(expectations);
  if (!first_violation(expectations)) return sentence;
  if (sentence == violated) return {};
  if (sentence.starts_with(violated + "; ")) sentence.erase(0, violated.size() + 2);
  if (sentence.ends_with("; " + violated)) sentence.resize(sentence.size() - violated.size() - 2);
  return sentence;
}

ReportJson ReportMaker::verdict_json() const {
  ReportJson verdict{{"sentence", summary_.verdict},
                     {"besides", besides_violations(summary_.verdict, expectations_)},
                     {"state", summary_.state},
                     {"notes", options_.notes}};
  if (options_.verdict && !options_.verdict->levels.empty()) verdict["levels"] = options_.verdict->levels;
  return verdict;
}

/// Judges the whole recording, of which the report may show a part.
void ReportMaker::judge_expectations(const fs::path& file) {
  if (options_.expectations || !scenario_ || scenario_->expectations.empty()) {
    expectations_ = options_.expectations.value_or(std::vector<ExpectationResult>());
    return;
  }
  if (!options_.from && !options_.until) {
    expectations_ = rehearse::judge_expectations(scenario_->expectations, actual_.trace);
    return;
  }
  auto judged = rehearse::judge_expectations(scenario_->expectations, file);
  if (judged)
    expectations_ = *std::move(judged);
  else
    summary_.omitted.push_back("The expectations were not judged: " + judged.errors()[0].message);
}

void ReportMaker::conclude() {
  const bool is_violated = first_violation(expectations_) != nullptr;
  const std::string outcome = outcome_of(RunFacts::of(actual_.trace));
  if (options_.verdict) {
    summary_.verdict = options_.verdict->sentence;
    summary_.state = options_.verdict->state;
    return;
  }
  if (comparison_) {
    summary_.verdict = verdict(*comparison_, options_.horizon);
    summary_.state = !comparison_->within ? "beyond" : comparison_->equal ? "equal" : "within";
  } else if (!outcome.empty()) {
    summary_.verdict = outcome;
    summary_.state = "failed";
  } else if (summary_.begin == summary_.end) {
    summary_.verdict = "the recording has no ticks";
    summary_.state = "alone";
  } else {
    summary_.verdict = "a run by itself: there is nothing to compare it with";
    summary_.state = "alone";
  }
  if (expectations_.empty() || summary_.state == "failed") return;
  const std::string judged = verdict(expectations_);
  if (summary_.state == "alone")
    summary_.verdict = judged;
  else
    summary_.verdict = is_violated ? judged + "; " + summary_.verdict : summary_.verdict + "; " + judged;
  if (is_violated) summary_.state = "violated";
}

bool ReportMaker::is_wanted(const TraceChannel& channel) const {
  if (options_.topics.empty()) return true;
  return std::any_of(options_.topics.begin(), options_.topics.end(),
                     [&](const std::string& pattern) { return matches(pattern, channel.topic); });
}

/// Writes series and cameras of all requested channels, and of the channels that move robots.
void ReportMaker::write_channels(ReportJson& object) {
  RobotWriter robots(blobs_, actual_, options_.scenario, summary_.omitted);
  if (scenario_) robots.write(*scenario_);
  const JudgedValues* judged = judged_ ? &*judged_ : nullptr;
  SeriesWriter series(blobs_, actual_, golden(), judged);
  PictureWriter pictures(blobs_, actual_, golden(), judged, summary_.omitted);
  std::int64_t left_out = 0;
  const auto write = [&](const TraceChannel* actual, const TraceChannel* golden) {
    const TraceChannel& channel = actual ? *actual : *golden;
    if (is_picture(channel)) {
      if (is_wanted(channel)) pictures.write(actual, golden);
    } else if (is_wanted(channel) || robots.uses(channel.topic)) {
      series.write(actual, golden);
    } else {
      ++left_out;
    }
  };
  std::int64_t done = 0;
  const auto all = std::ssize(actual_.trace.channels()) + (golden_ ? std::ssize(golden_->trace.channels()) : 0);
  for (const TraceChannel& channel : actual_.trace.channels()) {
    write(&channel, golden_ ? counterpart(actual_.trace, channel, golden_->trace) : nullptr);
    if (options_.progress) options_.progress(++done, all);
  }
  if (golden_) {
    for (const TraceChannel& channel : golden_->trace.channels()) {
      if (!counterpart(golden_->trace, channel, actual_.trace)) write(nullptr, &channel);
      if (options_.progress) options_.progress(++done, all);
    }
  }
  if (left_out > 0)
    summary_.omitted.push_back(fmt::format("Of {} topics, which were not asked for, no series is shown.", left_out));
  object["axes"] = series.take_axes();
  object["series"] = series.take_series();
  object["cameras"] = pictures.take_cameras();
  object["robots"] = robots.take_robots();
  object["meshes"] = robots.take_meshes();
}

/// Writes messages and changes of contact.
void ReportMaker::write_happenings(ReportJson& object) {
  MessageWriter(blobs_, actual_, golden(), summary_.omitted)
      .write(object, summary_.first_tick.value_or(summary_.begin));
  ReportJson contacts = ReportJson::array();
  int index = 0;
  for (const ReportedRun* run : {&std::as_const(actual_), golden()}) {
    if (!run) continue;
    for (const msg::ContactChange& change : run->trace.contact_changes())
      contacts.push_back(
          {{"run", index}, {"tick", change.tick}, {"a", change.link}, {"b", change.other}, {"begins", change.begins}});
    ++index;
  }
  std::stable_sort(contacts.begin(), contacts.end(), [](const ReportJson& a, const ReportJson& b) {
    return a["tick"].get<std::int64_t>() < b["tick"].get<std::int64_t>();
  });
  object["contacts"] = std::move(contacts);
}

/// Requests the call stack of the first command that differs, if it is wanted and there is such a command.
void ReportMaker::request_call_stack(const Places& places) {
  if (!options_.call_stack) return;
  for (const bool wants_beyond : {true, false}) {
    for (const auto& [divergence, beyond] : places.all) {
      const ChannelName channel = ChannelName::parse(divergence.channel);
      if (beyond != wants_beyond || channel.side != ChannelSide::output) continue;
      const std::string command = channel.kind == ChannelKind::joints ? divergence.element : std::string();
      constexpr auto in_a_thread_if_possible = std::launch::async | std::launch::deferred;
      call_stack_ = std::async(in_a_thread_if_possible, options_.call_stack, channel.label(), command, divergence.tick);
      return;
    }
  }
  summary_.omitted.push_back("There is no call stack: no command of a controller differs");
}

/// The call stack. Null: none was requested, or there is none, which becomes an omission.
ReportJson ReportMaker::call_stack_json() {
  if (!call_stack_.valid()) return nullptr;
  const Result<CallStack> stack = call_stack_.get();
  if (stack) return json_of(*stack);
  summary_.omitted.push_back("There is no call stack: " + stack.errors()[0].message);
  return nullptr;
}

void ReportMaker::omit_damage() {
  for (const ReportedRun* run : {&std::as_const(actual_), golden()}) {
    if (!run || run->trace.damage().empty()) continue;
    const Diagnostics& damage = run->trace.damage();
    summary_.omitted.push_back(fmt::format("{} is incomplete, and lost data is not shown: {}{}",
                                           run == &actual_ ? "The recording" : "The golden", damage[0].message,
                                           damage.size() > 1 ? fmt::format(", and {} more", damage.size() - 1) : ""));
  }
}

Result<ReportSummary> ReportMaker::make(const fs::path& actual_file, const fs::path& golden_file) {
  omit_damage();
  const auto read_scenario = [&](const ReportedRun& run, std::optional<Scenario>& scenario) {
    auto read = recorded_scenario(run.trace);
    if (read)
      scenario = *std::move(read);
    else
      summary_.omitted.push_back("The scenario in the recording can't be read: " + read.errors()[0].message);
  };
  read_scenario(actual_, scenario_);
  if (golden_) read_scenario(*golden_, golden_scenario_);
  judge();
  TickRange range;
  range.take(actual_.clock);
  if (golden_) range.take(golden_->clock);
  summary_.begin = range.begin;
  summary_.end = range.end;
  judge_expectations(actual_file);
  conclude();

  const double time_step = time_step_of(actual_, scenario_);
  ReportJson object{{"format", 1},
                    {"title", options_.title.empty() ? actual_file.stem().string() : options_.title},
                    {"rehearse", REHEARSE_VERSION},
                    {"verdict", verdict_json()},
                    {"time_step", time_step},
                    {"begin", range.begin},
                    {"end", range.end}};
  ReportJson runs = ReportJson::array({run_json(actual_, "actual", actual_file)});
  if (golden_) runs.push_back(run_json(*golden_, "golden", golden_file));
  object["runs"] = std::move(runs);
  object["expectations"] =
      expectations_json(expectations_, time_step, range.begin, std::max(range.begin, range.end - 1));
  object["divergences"] = ReportJson::array();
  object["first"] = nullptr;
  object["worst"] = ReportJson::array();
  object["spans"] = ReportJson::array();
  if (comparison_) {
    if (scenario_ && golden_scenario_ && scenario_->name != golden_scenario_->name)
      object["runs"][1]["remarks"].push_back(
          fmt::format("it is of another scenario: {}, not {}", golden_scenario_->name, scenario_->name));
    for (const std::string& remark : comparison_->remarks) object["runs"][0]["remarks"].push_back(remark);
    const auto& told = options_.verdict ? options_.verdict->first : std::nullopt;
    const Places places(*comparison_, told ? &*told : nullptr);
    object["divergences"] = places_json(places, golden_->trace, actual_.trace);
    if (places.first) {
      object["first"] = *places.first;
      summary_.first_tick = places.all[*places.first].first.tick;
    }
    request_call_stack(places);
    object["worst"] = worst_json(*comparison_, golden_->trace, actual_.trace);
    for (const auto& [begin, end] : judged_->spans(most_spans)) object["spans"].push_back({begin, end});
  }
  const ExpectationResult* violation = first_violation(expectations_);
  if (!summary_.first_tick && violation && violation->first) summary_.first_tick = violation->first->tick;
  write_channels(object);
  write_happenings(object);
  object["call_stack"] = call_stack_json();
  object["omitted"] = summary_.omitted;
  if (auto done = file_.finish(object); !done) return done.errors();
  summary_.bytes = file_.bytes();
  summary_.data_bytes = file_.data_bytes();
  return summary_;
}

}  // namespace

Result<ReportSummary> write_report(const fs::path& trace, const std::optional<fs::path>& golden, const fs::path& report,
                                   const ReportOptions& options) {
  auto page = options.page.empty() ? report_page() : Result<fs::path>(options.page);
  if (!page) return page.errors();
  std::vector<fs::path> sources{trace};
  if (golden) sources.push_back(*golden);
  if (auto fits = check_report_size(sources, report, options); !fits) return fits.errors();
  sources.push_back(*page);
  auto file = ReportFile::begin(report, *page, sources);
  if (!file) return file.errors();
  const auto actual = SourceTrace::load(trace, report.string() + ".actual.part", options);
  if (!actual) return actual.errors();
  std::optional<Result<SourceTrace>> expected;
  if (golden) expected.emplace(SourceTrace::load(*golden, report.string() + ".golden.part", options));
  if (expected && !*expected) return expected->errors();
  ReportMaker maker(options, *file, actual->trace(), expected ? &(*expected)->trace() : nullptr);
  return maker.make(trace, golden ? *golden : fs::path());
}

}  // namespace rehearse
