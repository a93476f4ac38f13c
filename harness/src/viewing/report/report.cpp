// Makes a report in the order of its steps.
#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "base/glob.h"
#include "core/check/expectation_judge.h"
#include "core/compare/compared_files.h"
#include "core/compare/compared_traces.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "report_coverage.h"
#include "report_facts.h"
#include "report_findings.h"
#include "report_messages.h"
#include "report_page.h"
#include "report_pictures.h"
#include "report_robots.h"
#include "report_rows.h"
#include "report_run.h"
#include "report_series.h"
#include "report_source.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_spans = 1000;

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

/// The sizes of a report's parts: coded bytes of blobs, which base64 makes a third larger.
struct PartSizes {
  std::uint64_t series = 0, pictures = 0, all = 0;

  /// The parts of a report of that size [bytes]. The rest is for meshes and texts.
  static PartSizes of(std::uintmax_t size, bool has_pictures, bool has_messages) {
    const double coded = 0.75 * static_cast<double>(size);
    const auto part = [coded](double share) { return static_cast<std::uint64_t>(share * coded); };
    const double pictures = has_pictures ? 0.25 : 0.0, messages = has_messages ? 0.25 : 0.0;
    return {part(0.9 - pictures - messages), part(pictures), part(0.9)};
  }
};

/// Writes one report.
class ReportMaker {
 public:
  using OpenFile = std::function<Result<ReportFile>()>;
  ReportMaker(const ReportOptions& options, OpenFile open, ReportedRun actual, std::optional<ReportedRun> golden)
      : options_(options), open_(std::move(open)), actual_(std::move(actual)), golden_(std::move(golden)) {}

  Result<ReportSummary> make(const fs::path& actual_file, const fs::path& golden_file);

 private:
  const ReportedRun* golden() const { return golden_ ? &*golden_ : nullptr; }
  Result<void> judge();
  void judge_expectations(const fs::path& file);
  void conclude();
  ReportJson verdict_json() const;
  void find_focus();
  PartSizes part_sizes() const;
  std::vector<ChannelPair> channel_pairs() const;
  Result<ReportJson> head(const fs::path& actual_file, const fs::path& golden_file);
  /// A try to write the file with some number of numbers.
  struct Attempt {
    double fill = 0.0;  // size of the series, as a share of their part of the report
    bool is_written = false;
  };
  Result<Attempt> write(ReportJson object, std::uint64_t most_cells, bool is_trial);
  struct WrittenSeries {
    std::uint64_t coded = 0;  // [bytes]
    bool is_limited = false;  // more numbers could be shown
  };
  Result<WrittenSeries> write_channels(ReportJson& object, BlobWriter& blobs, std::uint64_t most_cells);
  void write_happenings(ReportJson& object, BlobWriter& blobs);
  void omit_rows(const ShownRows& rows);
  bool is_wanted(const TraceChannel& channel) const;
  void omit_damage();
  void request_call_stack(const Places& places);
  ReportJson call_stack_json();

  const ReportOptions& options_;
  const OpenFile open_;
  const ReportedRun actual_;
  const std::optional<ReportedRun> golden_;
  std::optional<Scenario> scenario_, golden_scenario_;  // none: it can't be read
  std::optional<Comparison> comparison_;
  std::optional<JudgedValues> judged_;
  std::vector<ExpectationResult> expectations_;  // of the run
  ReportJson coverage_;                          // null: none
  RowFocus focus_;
  std::vector<std::string> omitted_;           // before anything is written
  std::future<Result<CallStack>> call_stack_;  // while the series are written, as a debugger takes seconds
  ReportSummary summary_;
  std::string besides_;  // the verdict without violated expectations
};

/// Compares both recordings as `diff` does. That finds the ticks and values to mark, also if the findings are given.
Result<void> ReportMaker::judge() {
  if (!golden_) return {};
  std::vector<ToleranceRule> rules;
  if (options_.tolerances)
    rules = *options_.tolerances;
  else if (golden_scenario_)
    rules = golden_scenario_->tolerances;
  judged_.emplace(*golden_);
  CompareOptions how;
  how.until = options_.horizon;
  how.on_difference = [this](const DifferingValue& value) { judged_->take(value); };
  auto compared = REHEARSE_TRY(
      compare_files(golden_->file, actual_.file, rules, how, {}, Trace::usual_piece_size, Trace::Damage::tolerate));
  comparison_ = options_.comparison ? *options_.comparison : std::move(compared.comparison);
  judged_->conclude(*comparison_);
  return {};
}

ReportJson ReportMaker::verdict_json() const {
  ReportJson verdict{
      {"sentence", summary_.verdict}, {"besides", besides_}, {"state", summary_.state}, {"notes", options_.notes}};
  if (options_.verdict && !options_.verdict->levels.empty()) verdict["levels"] = options_.verdict->levels;
  return verdict;
}

/// Judges the whole recording, of which the report may show a part.
void ReportMaker::judge_expectations(const fs::path& file) {
  if (options_.expectations || !scenario_ || scenario_->expectations.empty()) {
    expectations_ = options_.expectations.value_or(std::vector<ExpectationResult>());
    return;
  }
  auto judged = rehearse::judge_expectations(scenario_->expectations, file, Trace::Damage::tolerate);
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
    besides_ = options_.verdict->besides.value_or(summary_.verdict);
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
  besides_ = summary_.verdict;
  if (expectations_.empty() || summary_.state == "failed") return;
  const std::string judged = verdict(expectations_);
  const bool is_alone = summary_.state == "alone";
  if (is_alone)
    summary_.verdict = judged;
  else
    summary_.verdict = is_violated ? judged + "; " + summary_.verdict : summary_.verdict + "; " + judged;
  if (!is_violated)
    besides_ = summary_.verdict;
  else if (is_alone)
    besides_.clear();
  if (is_violated) summary_.state = "violated";
}

bool ReportMaker::is_wanted(const TraceChannel& channel) const {
  if (options_.topics.empty()) return true;
  return std::ranges::any_of(options_.topics,
                             [&](const std::string& pattern) { return matches(pattern, channel.topic); });
}

/// The channels of both runs with the same topic, in the order of the run; then those of the golden alone.
std::vector<ChannelPair> ReportMaker::channel_pairs() const {
  std::vector<ChannelPair> pairs;
  for (const TraceChannel& channel : actual_.trace.channels()) {
    const TraceChannel* other = golden_ ? counterpart(actual_.trace, channel, golden_->trace) : nullptr;
    ChannelPair& pair = pairs.emplace_back();
    pair.actual = actual_.place_of(channel);
    if (other) pair.golden = golden_->place_of(*other);
  }
  if (!golden_) return pairs;
  for (const TraceChannel& channel : golden_->trace.channels())
    if (!counterpart(golden_->trace, channel, actual_.trace))
      pairs.push_back({std::nullopt, golden_->place_of(channel)});
  return pairs;
}

/// Chooses the times to show completely, if the runs are too long to show all.
void ReportMaker::find_focus() {
  const double time_step = time_step_of(actual_, scenario_);
  const auto time_of = [&](std::int64_t tick) {
    return static_cast<std::uint64_t>(std::llround(std::max(0.0, static_cast<double>(tick) * time_step * 1e9)));
  };
  focus_.around = 2 * time_of(1);
  if (summary_.first_tick) focus_.centre = time_of(*summary_.first_tick);
  const auto mark = [&](const auto& place) {
    if (place) focus_.marks.push_back(time_of(place->tick));
  };
  if (comparison_)
    for (const ChannelComparison& channel : comparison_->channels)
      for (const auto* place : {&channel.first, &channel.first_bit, &channel.worst}) mark(*place);
  for (const ExpectationResult& result : expectations_)
    for (const auto* sample : {&result.first, &result.worst}) mark(*sample);
  std::ranges::sort(focus_.marks);
}

PartSizes ReportMaker::part_sizes() const {
  bool has_pictures = false;
  std::uint64_t messages = 0;
  for (const ReportedRun* run : {&actual_, golden()}) {
    if (!run) continue;
    for (const TraceChannel& channel : run->trace.channels()) {
      has_pictures = has_pictures || (is_picture(channel) && is_wanted(channel));
      if (channel.type == msg::Event::type_name) messages += run->of(channel).messages;
    }
  }
  return PartSizes::of(options_.max_size, has_pictures, messages > MessageWriter::Limits().listed);
}

/// Writes series and cameras of all requested channels, and of the channels that move robots.
Result<ReportMaker::WrittenSeries> ReportMaker::write_channels(ReportJson& object, BlobWriter& blobs,
                                                               std::uint64_t most_cells) {
  RobotWriter robots(blobs, actual_, options_.scenario, summary_.omitted);
  if (scenario_) robots.write(*scenario_);
  std::vector<ChannelPair> shown;
  std::int64_t left_out = 0, cameras = 0;
  for (const ChannelPair& pair : channel_pairs()) {
    const TraceChannel& channel =
        pair.actual ? actual_.trace.channels()[*pair.actual] : golden_->trace.channels()[*pair.golden];
    const bool is_camera = is_picture(channel);
    if (is_wanted(channel) || (!is_camera && robots.uses(channel.topic))) {
      if (is_camera || !channel.columns.empty()) shown.push_back(pair);
      if (is_camera) ++cameras;
    } else if (!is_camera) {
      ++left_out;
    }
  }
  const auto all = std::ssize(shown);
  ShownRows rows(actual_, golden(), std::move(shown), focus_, most_cells);
  const JudgedValues* judged = judged_ ? &*judged_ : nullptr;
  SeriesWriter series(blobs, actual_, golden(), judged);
  PictureWriter pictures(blobs, actual_, golden(), judged, focus_,
                         part_sizes().pictures / static_cast<std::uint64_t>(std::max<std::int64_t>(1, cameras)),
                         summary_.omitted);
  std::int64_t done = 0;
  std::uint64_t series_size = 0;
  REHEARSE_TRY(rows.for_each([&](const ShownChannel& channel) {
    const std::uint64_t before = blobs.coded();
    if (is_picture(channel.either())) {
      pictures.write(channel);
    } else {
      series.write(channel);
      series_size += blobs.coded() - before;
    }
    if (options_.progress) options_.progress(++done, all);
  }));
  omit_rows(rows);
  if (left_out > 0)
    summary_.omitted.push_back(fmt::format("Of {} topics, which were not asked for, no series is shown.", left_out));
  object["axes"] = series.take_axes();
  object["series"] = series.take_series();
  object["cameras"] = pictures.take_cameras();
  object["robots"] = robots.take_robots();
  object["meshes"] = robots.take_meshes();
  return WrittenSeries{series_size, rows.is_limited()};
}

/// Reports the choice of messages, if it isn't all of them.
void ReportMaker::omit_rows(const ShownRows& rows) {
  if (!rows.is_thinned()) return;
  std::string sentence =
      "The run is too long to show all values of its series: shown are the lowest and highest, the "
      "first that differ, and others at equal distances";
  if (focus_.centre) {
    const double centre = static_cast<double>(*focus_.centre) / 1e9, half = 0.5 * rows.whole_span();
    sentence +=
        fmt::format(". From {:.6g} s to {:.6g} s all values are shown", std::max(0.0, centre - half), centre + half);
  }
  summary_.omitted.push_back(
      sentence + ". Options: --from and --until show all values of another span, --max-size shows more of the run.");
}

/// Writes messages and changes of contact.
void ReportMaker::write_happenings(ReportJson& object, BlobWriter& blobs) {
  MessageWriter::Limits limits;
  const std::uint64_t all = part_sizes().all;
  limits.of_blobs = std::min(limits.of_blobs, all - std::min(all, blobs.coded()));
  MessageWriter(blobs, actual_, golden(), summary_.omitted, limits)
      .write(object, summary_.first_tick.value_or(summary_.begin));
  ReportJson contacts = ReportJson::array();
  int index = 0;
  for (const ReportedRun* run : {&actual_, golden()}) {
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
  for (const ReportedRun* run : {&actual_, golden()}) {
    if (!run || run->trace.damage().empty()) continue;
    const Diagnostics& damage = run->trace.damage();
    summary_.omitted.push_back(fmt::format("{} is incomplete, and lost data is not shown: {}{}",
                                           run == &actual_ ? "The recording" : "The golden", damage[0].message,
                                           damage.size() > 1 ? fmt::format(", and {} more", damage.size() - 1) : ""));
  }
}

/// Judges the run, and makes all of the report's object except its series, pictures and messages.
Result<ReportJson> ReportMaker::head(const fs::path& actual_file, const fs::path& golden_file) {
  coverage_ = REHEARSE_TRY(coverage_with_sources(options_.coverage));
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
  REHEARSE_TRY(judge());
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
  find_focus();
  return object;
}

/// Writes the file with at most about so many numbers; a trial only if their size suits the report.
Result<ReportMaker::Attempt> ReportMaker::write(ReportJson object, std::uint64_t most_cells, bool is_trial) {
  auto file = REHEARSE_TRY(open_());
  BlobWriter blobs([&file](const std::string& id, ByteSpan coded) { file.put_blob(id, coded); });
  summary_.omitted = omitted_;
  auto series = REHEARSE_TRY(write_channels(object, blobs, most_cells));
  Attempt attempt{static_cast<double>(series.coded) / static_cast<double>(part_sizes().series), false};
  constexpr double too_small = 0.4;
  if (is_trial && (attempt.fill > 1.0 || (attempt.fill < too_small && series.is_limited))) return attempt;
  write_happenings(object, blobs);
  object["call_stack"] = call_stack_json();
  object["control_times"] = json_of(options_.control_times);
  object["coverage"] = coverage_entry(blobs, coverage_);
  object["omitted"] = summary_.omitted;
  REHEARSE_TRY(file.finish(object));
  summary_.bytes = file.bytes();
  summary_.data_bytes = file.data_bytes();
  attempt.is_written = true;
  return attempt;
}

Result<ReportSummary> ReportMaker::make(const fs::path& actual_file, const fs::path& golden_file) {
  const auto object = REHEARSE_TRY(head(actual_file, golden_file));
  omitted_ = summary_.omitted;
  // A number takes about a byte, coded; random ones take eight, others that hardly change a tenth.
  constexpr int most_trials = 3;
  std::uint64_t cells = options_.max_size;
  for (int trial = 0;; ++trial) {
    const auto attempt = REHEARSE_TRY(write(object, cells, trial < most_trials));
    if (attempt.is_written) return summary_;
    cells = static_cast<std::uint64_t>(0.85 * static_cast<double>(cells) / std::max(0.05, attempt.fill));
  }
}

}  // namespace

Result<ReportSummary> write_report(const fs::path& trace, const std::optional<fs::path>& golden, const fs::path& report,
                                   const ReportOptions& options) {
  auto page = REHEARSE_TRY(options.page.empty() ? report_page() : Result<fs::path>(options.page));
  std::vector<fs::path> sources{trace};
  if (golden) sources.push_back(*golden);
  sources.push_back(page);
  const auto open = [&] { return ReportFile::begin(report, page, sources); };
  REHEARSE_TRY(open());  // before the work
  const auto actual_file = REHEARSE_TRY(SourceFile::make(trace, report.string() + ".actual.part", options));
  auto actual = REHEARSE_TRY(read_run(actual_file, trace));
  std::optional<Result<SourceFile>> golden_file;
  std::optional<ReportedRun> expected;
  if (golden) {
    golden_file.emplace(SourceFile::make(*golden, report.string() + ".golden.part", options));
    if (!*golden_file) return golden_file->errors();
    expected = REHEARSE_TRY(read_run(**golden_file, *golden));
  }
  ReportMaker maker(options, open, std::move(actual), std::move(expected));
  return maker.make(trace, golden ? *golden : fs::path());
}

}  // namespace rehearse
