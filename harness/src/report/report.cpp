// Makes a report in the order of its steps.
#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "compare/compare_parts.h"
#include "compare/counterpart.h"
#include "compare/report_json.h"
#include "mcap/glob.h"
#include "report_page.h"
#include "report_pictures.h"
#include "report_robots.h"
#include "report_run.h"
#include "report_series.h"
#include "report_size.h"
#include "scenario/trace_scenario.h"
#include "trace/filter.h"

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

mcap::Moment moment_of(double seconds) {
  return {static_cast<std::uint64_t>(std::llround(std::max(0.0, seconds) * 1e9)), false};
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
    if (filtered->messages == 0)
      return error_in(file.string(), "nothing was recorded in the span that is asked for",
                      "rehearse info tells how long it is");
  }
  auto trace = Trace::load(is_part ? scratch : file, Trace::Damage::tolerate);
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
    const std::int64_t first = clock.tick_at(clock.times().front()), last = clock.tick_at(clock.last_time());
    begin = begin == end ? first : std::min(begin, first);
    end = std::max(end, last + 1);
  }
};

/// A sentence about the end of a run; empty: it ended regularly.
std::string outcome_of(const RunFacts& run) {
  return run.outcome ? run.outcome->failure.value_or("") : "the recording was cut: nothing says how the run ended";
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
  const std::int64_t messages = trace.ticks();
  const std::int64_t ticks = stated.outcome ? stated.outcome->ticks.value_or(messages) : messages;
  return {
      {"role", role},
      {"file", file.filename().string()},
      {"ticks", std::min(ticks, messages)},
      {"complete", stated.outcome && stated.outcome->complete},
      {"outcome", outcome_of(stated)},
      {"facts", std::move(provenance)},
      {"scenario", scenario ? std::string(reinterpret_cast<const char*>(scenario->data.data()), scenario->data.size())
                            : std::string()},
      {"remarks", std::move(remarks)}};
}

/// [s]; for a recording whose scenario can't be read, by its clock.
double time_step_of(const ReportedRun& run, const std::optional<Scenario>& scenario) {
  if (scenario) return scenario->time_step;
  const std::vector<std::uint64_t>& times = run.clock.times();
  constexpr double usual = 0.001;
  return times.size() < 2 || times[1] <= times[0] ? usual : static_cast<double>(times[1] - times[0]) / 1e9;
}

/// The name of the series of a divergence; null: it has none.
ReportJson series_at(const Divergence& divergence, const Trace& golden, const Trace* actual) {
  for (const Trace* trace : {actual, &golden}) {
    const TraceChannel* channel = trace ? trace->find_channel(divergence.channel) : nullptr;
    if (!channel) continue;
    const std::size_t column = column_of(*channel, divergence.element);
    if (column < channel->columns.size()) return channel->columns[column].series;
  }
  return nullptr;
}

/// The differences by tick: for each channel the first beyond tolerance, and the first in any bit.
struct Places {
  std::vector<std::pair<Divergence, bool>> all;  // true: it is beyond tolerance
  std::optional<std::size_t> first;

  /// `told`: the first difference by a more precise judgement; null: none.
  Places(const Comparison& comparison, const Divergence* told) {
    for (const ChannelComparison& channel : comparison.channels) {
      if (channel.first) all.emplace_back(*channel.first, true);
      if (channel.first_bit && (!channel.first || to_string(*channel.first) != to_string(*channel.first_bit)))
        all.emplace_back(*channel.first_bit, false);
    }
    const Divergence* wanted = told;
    if (!wanted && comparison.first) wanted = &*comparison.first;
    if (!wanted && comparison.first_bit) wanted = &*comparison.first_bit;
    if (!wanted) return;
    const std::string text = to_string(*wanted);
    if (std::none_of(all.begin(), all.end(), [&](const auto& place) { return to_string(place.first) == text; }))
      all.emplace_back(*wanted, true);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return comes_before(a.first, b.first); });
    for (std::size_t i = 0; i < all.size() && !first; ++i)
      if (to_string(all[i].first) == text) first = i;
  }
};

ReportJson places_json(const Places& places, const Trace& golden, const Trace& actual) {
  ReportJson list = ReportJson::array();
  for (const auto& [divergence, beyond] : places.all) {
    ReportJson place = json_of(std::optional<Divergence>(divergence));
    place["series"] = series_at(divergence, golden, &actual);
    place["beyond"] = beyond;
    list.push_back(std::move(place));
  }
  return list;
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
  ReportJson verdict_json() const;
  void write_channels(ReportJson& object);
  void write_happenings(ReportJson& object) const;
  bool is_wanted(const TraceChannel& channel) const;
  void omit_damage();

  const ReportOptions& options_;
  ReportFile& file_;
  BlobWriter blobs_;
  ReportedRun actual_;
  std::optional<ReportedRun> golden_;
  std::optional<Scenario> scenario_, golden_scenario_;  // none: it can't be read
  std::optional<Comparison> comparison_;
  std::optional<JudgedValues> judged_;
  ReportSummary summary_;
};

/// Compares both recordings as `diff` does.
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
  judged_->conclude(*comparison_);
}

ReportJson ReportMaker::verdict_json() const {
  ReportJson verdict{{"sentence", summary_.verdict}, {"state", summary_.state}};
  if (options_.verdict && !options_.verdict->levels.empty()) verdict["levels"] = options_.verdict->levels;
  return verdict;
}

void conclude(ReportSummary& summary, const ReportOptions& options, const Comparison* comparison,
              const std::string& outcome) {
  if (options.verdict) {
    summary.verdict = options.verdict->sentence;
    summary.state = options.verdict->state;
  } else if (comparison) {
    summary.verdict = verdict(*comparison, options.horizon);
    summary.state = !comparison->within ? "beyond" : comparison->equal ? "equal" : "within";
  } else if (!outcome.empty()) {
    summary.verdict = outcome;
    summary.state = "failed";
  } else if (summary.begin == summary.end) {
    summary.verdict = "the recording has no ticks";
    summary.state = "alone";
  } else {
    summary.verdict = "a run by itself: there is nothing to compare it with";
    summary.state = "alone";
  }
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

void ReportMaker::write_happenings(ReportJson& object) const {
  ReportJson events = ReportJson::array(), contacts = ReportJson::array();
  int index = 0;
  for (const ReportedRun* run : {&actual_, golden()}) {
    if (!run) continue;
    for (const msg::Event& event : run->trace.events())
      events.push_back({{"run", index},
                        {"tick", event.tick},
                        {"severity", event.severity},
                        {"source", event.source},
                        {"text", event.text}});
    for (const msg::ContactChange& change : run->trace.contact_changes())
      contacts.push_back(
          {{"run", index}, {"tick", change.tick}, {"a", change.link}, {"b", change.other}, {"begins", change.begins}});
    ++index;
  }
  const auto by_tick = [](const ReportJson& a, const ReportJson& b) {
    return a["tick"].get<std::int64_t>() < b["tick"].get<std::int64_t>();
  };
  std::stable_sort(events.begin(), events.end(), by_tick);
  std::stable_sort(contacts.begin(), contacts.end(), by_tick);
  object["events"] = std::move(events);
  object["contacts"] = std::move(contacts);
}

void ReportMaker::omit_damage() {
  for (const ReportedRun* run : {&std::as_const(actual_), golden()}) {
    if (!run || run->trace.damage().empty()) continue;
    const Diagnostics& damage = run->trace.damage();
    summary_.omitted.push_back(fmt::format("{} is not whole, and what is lost is not shown: {}{}",
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
  conclude(summary_, options_, comparison_ ? &*comparison_ : nullptr, outcome_of(RunFacts::of(actual_.trace)));

  ReportJson object{{"format", 1},
                    {"title", scenario_ ? scenario_->name : actual_file.stem().string()},
                    {"rehearse", REHEARSE_VERSION},
                    {"verdict", verdict_json()},
                    {"time_step", time_step_of(actual_, scenario_)},
                    {"begin", range.begin},
                    {"end", range.end}};
  ReportJson runs = ReportJson::array({run_json(actual_, "actual", actual_file)});
  if (golden_) runs.push_back(run_json(*golden_, "golden", golden_file));
  object["runs"] = std::move(runs);
  object["divergences"] = ReportJson::array();
  object["first"] = nullptr;
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
    for (const auto& [begin, end] : judged_->spans(most_spans)) object["spans"].push_back({begin, end});
  }
  write_channels(object);
  write_happenings(object);
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
