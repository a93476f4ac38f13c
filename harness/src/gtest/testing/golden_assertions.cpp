// EXPECT_MATCHES_GOLDEN and EXPECT_HOLDS, without GoogleTest.
#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/golden.h>
#include <rehearse/gtest.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "base/glob.h"
#include "core/check/code_of.h"
#include "core/check/compared.h"
#include "core/check/noise_floor.h"
#include "core/check/unknown_series.h"
#include "core/golden/run_folder.h"
#include "core/host/odd_command.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "test_history.h"
#include "test_recordings.h"
#include "test_reports.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;

/// The scenario that determines how a recording is judged. A recording of other programs contains no scenario: then the
/// defaults apply.
Result<Scenario> scenario_in(const Trace& trace) {
  if (!trace.find_attachment("scenario.yaml")) return Scenario();
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace.file()));
  auto scenario = scenario_of(*reader);
  if (!scenario) return scenario;
  if (const std::string file = scenario_file_of(trace); !file.empty()) {
    for (Expectation& expectation : scenario->expectations) expectation.place.file = file;
    for (ToleranceRule& rule : scenario->tolerances) rule.place.file = file;
  }
  return scenario;
}

bool is_at_least_0(double value) { return std::isfinite(value) && value >= 0.0; }

bool has_series(const Trace& trace, const std::string& pattern) {
  const auto& series = trace.series();
  if (std::ranges::any_of(series, [&](const auto& named) { return matches(pattern, named.first); })) return true;
  return std::ranges::any_of(trace.channels(),  // pictures have no series
                             [&](const TraceChannel& channel) { return matches("/" + pattern, channel.topic); });
}

/// A mistake in the options; empty if there is none.
std::string mistake_in(const MatchOptions& options, const Trace& trace) {
  for (const Near& near : options.near) {
    if (!is_at_least_0(near.atol) || !is_at_least_0(near.rtol))
      return fmt::format("Near{{\"{}\", {}, {}}}: a tolerance is a number, at least 0", near.channel, near.atol,
                         near.rtol);
    if (!has_series(trace, near.channel))
      return fmt::format("Near{{\"{}\", ...}}: the run has no such series; the nearest are {}", near.channel,
                         trace.nearest_series(near.channel));
  }
  constexpr double resolution = 1e-9;  // of times in a trace [s]
  if (options.until && !(*options.until >= 0.0 && *options.until <= trace.duration() + resolution))
    return fmt::format("Until{{{}}}: expected a time in the run, 0 to {} s", *options.until, trace.duration());
  if (options.levels.empty()) return "Levels{}: expected controller, plant or closed";
  return {};
}

/// The names in the scenario that no run of it can have, an error in each line; empty: there are none.
std::string unknown_names(const Scenario& scenario, const Trace& trace, const fs::path& golden) {
  const Trace* traces[] = {&trace, nullptr};
  const auto outcome = RunFacts::of(trace).outcome;
  if (!outcome || outcome->failure || unknown_series(scenario, {traces, 1}).empty()) return {};
  const auto other = Trace::load_in_pieces(golden, [](const Trace&) {});
  if (other) traces[1] = &*other;
  return to_string(unknown_series(scenario, {traces, other ? 2u : 1u}));
}

ToleranceRule rule_for(std::string channel, double atol, double rtol) {
  ToleranceRule rule;
  rule.channel = std::move(channel);
  rule.atol = atol;
  rule.rtol = rtol;
  return rule;
}

std::vector<ToleranceRule> rules_of(const Scenario& scenario, const MatchOptions& options) {
  std::vector<ToleranceRule> rules = scenario.tolerances;
  if (options.exact) rules.push_back(equal_bits());
  for (const Near& near : options.near) rules.push_back(rule_for(near.channel, near.atol, near.rtol));
  return rules;
}

bool wants(const MatchOptions& options, Level level) {
  return std::ranges::find(options.levels, level) != options.levels.end();
}

/// The horizon by the measured noise of a golden, if it was measured.
std::optional<double> measured_horizon(const fs::path& golden) {
  std::error_code ignored;
  if (!fs::exists(noise_file_of(golden), ignored)) return std::nullopt;
  const auto trace = Trace::load(golden);
  return trace ? estimated_horizon(*trace) : std::nullopt;
}

/// The errors that the run of a recording had, which didn't end it.
Diagnostics errors_in(const Trace& trace) {
  Diagnostics errors;
  for (const msg::Event& event : trace.events())
    if (event.severity == to_string(Severity::error)) errors.push_back(error(event.source + ": " + event.text));
  return errors;
}

/// The first command of a recording that isn't finite; none: its commands are finite.
std::optional<OddCommand> odd_command_in(const Trace& trace) {
  RunSummary run;
  run.remarks = errors_in(trace);
  return odd_command_of(run);
}

/// The result of a check whose run is replaced by this recording.
Result<CheckReport> check_recording(const Trace& trace, const Scenario& judged_by, const MatchOptions& options,
                                    const fs::path& golden, const fs::path& actual) {
  auto scenario = Scenario::load(scenario_file_of(trace));  // with all its meshes, which a recording lacks
  if (!scenario) return scenario.errors();
  scenario->tolerances = judged_by.tolerances;
  scenario->horizon = judged_by.horizon;
  CheckOptions levels;
  levels.controller = wants(options, Level::controller);
  levels.plant = wants(options, Level::plant);
  levels.closed = wants(options, Level::closed);
  const auto take_recording = [&](const Scenario&, const fs::path& file, const RecordOptions&) -> Result<RunSummary> {
    std::error_code failed;
    fs::copy_file(trace.file(), file, fs::copy_options::overwrite_existing, failed);
    if (failed) return error(fmt::format("can't write {}: {}", file.string(), failed.message()));
    RunSummary run;
    run.remarks = errors_in(trace);
    return run;
  };
  const auto proving = proof_mode();
  if (proving && proving->on && !levels.closed) levels.certificates = certificates_of(golden_store());
  return check_scenario(*scenario, golden, actual, levels, {take_recording, run_plant, describe_plant});
}

/// The reason why a run of this program must not become a golden: it doesn't repeat itself. Empty if it does.
Result<std::string> doubt_about(const Trace& trace) {
  if (scenario_file_of(trace).empty()) return std::string();
  const auto scenario = REHEARSE_TRY(Scenario::load(scenario_file_of(trace)));
  const auto found =
      REHEARSE_TRY(reproduce(scenario, trace, fs::path(trace.file()).concat(".again"), {}, simulation()));
  return found.reproduced() ? std::string() : found.verdict;
}

/// The text that `rehearse check` would print.
std::string text_of(const CheckReport& report, const fs::path& golden, const std::string& name) {
  std::string text = report.verdict.text() + '\n';
  if (const std::string bits = bits_sentence(report); !bits.empty()) text += fmt::format("  {}\n", bits);
  text += fmt::format("  {}\n", levels_text(report));
  text += tables_text(report);
  text += fmt::format("golden: {}\n{}", golden.string(), report.message);
  if (!report.run_is_wrong()) return text;
  if (report.run && odd_command_of(*report.run)) return text;  // neither the golden nor the expectations are at fault
  if (const ExpectationResult* violation = first_violation(report.expectations))
    return text +
           fmt::format("\nif the run is right, correct the expectations in {}", violation->expectation.place.file);
  return text + '\n' + acceptance_advice(name);
}

/// Checks the requested levels; for a run that differs also finds the faulty part.
TestVerdict check_levels(const Trace& trace, const std::string& test, const Scenario& judged_by,
                         const MatchOptions& options, GoldenResult settled, bool wrong, const GoldenStore& store,
                         std::optional<CheckReport>& checked) {
  const bool beside_closed = wants(options, Level::controller) || wants(options, Level::plant);
  // A run within tolerance with different bits must repeat itself; a check tests this.
  const bool certain = !settled.comparison || settled.comparison->equal || scenario_file_of(trace).empty();
  if (settled.passed && !beside_closed && certain) return {true, std::move(settled.message)};
  // Without a golden or without wrong values no part is faulty.
  const bool differs = settled.comparison && (wrong || !settled.comparison->within);
  if (!settled.passed && !differs) return {false, std::move(settled.message)};
  if (scenario_file_of(trace).empty()) {
    if (!beside_closed) return {settled.passed, std::move(settled.message)};
    return {false, "the levels controller and plant need a recording that this program made by rehearse::record()"};
  }
  const auto report = check_recording(trace, judged_by, options, store.trace_file(test), store.pending_file(test));
  if (!report) return {false, settled.message + "\n" + to_string(report.errors())};
  checked = *report;
  if (!compared_anything(*report))
    return {false, "nothing was compared: " + text_of(*report, store.trace_file(test), test)};
  if (settled.passed && report->within()) return {true, report->verdict.text()};
  return {false, text_of(*report, store.trace_file(test), test)};
}

/// The code of a run that was compared with its golden as a whole.
VerdictCode code_of(const GoldenResult& settled) {
  if (settled.written) return VerdictCode::golden_written;
  if (!settled.comparison) return settled.passed ? VerdictCode::same : VerdictCode::golden_missing;
  if (!settled.comparison->within) return VerdictCode::run_changed;
  return settled.comparison->equal ? VerdictCode::same : VerdictCode::within_tolerance;
}

/// The statements of a comparison and of its expectations, as codes.
Verdict verdict_of(const GoldenResult& settled, const std::vector<ExpectationResult>& expectations) {
  Verdict verdict(code_of(settled), "");
  if (expectations.empty()) return verdict;
  if (first_violation(expectations))
    verdict.lead(rehearse::code_of(expectations));
  else
    verdict.add(rehearse::code_of(expectations));
  return verdict;
}

/// The verdict on a recording, and the findings on the way to it, for its report.
TestVerdict judge(const Trace& trace, const std::string& test, const MatchOptions& options, GoldenStore& store,
                  ComparedTest& compared) {
  const auto mode = golden_mode();
  if (!mode) return {false, to_string(mode.errors())};
  if (std::string mistake = mistake_in(options, trace); !mistake.empty()) return {false, std::move(mistake)};
  auto scenario = scenario_in(trace);
  if (!scenario) return {false, to_string(scenario.errors())};
  if (std::string names = unknown_names(*scenario, trace, store.trace_file(test)); !names.empty())
    return {false, std::move(names)};
  scenario->tolerances = rules_of(*scenario, options);
  scenario->horizon = options.until ? options.until : horizon_of(*scenario, measured_horizon(store.trace_file(test)));
  compared.golden = store.trace_file(test);
  compared.scenario = scenario_file_of(trace);
  compared.tolerances = scenario->tolerances;
  compared.horizon = scenario->horizon;
  const auto expectations = judge_expectations(scenario->expectations, trace);
  if (const std::string closest = closest_of(expectations); !closest.empty()) fmt::print("{}\n", closest);
  SettleOptions settling;
  settling.compare.until = scenario->horizon;
  settling.exact = options.exact && options.near.empty();
  if (first_violation(expectations)) settling.violation = verdict(expectations);
  if (*mode != GoldenMode::check && settling.violation.empty()) {
    auto doubt = doubt_about(trace);
    if (!doubt) return {false, to_string(doubt.errors())};
    settling.violation = *std::move(doubt);
  }
  if (!store.has(test)) settling.hint = hint_for_missing(golden_store(), test);  // `store` has no notes of tests
  const bool is_compared = wants(options, Level::closed) || *mode != GoldenMode::check || !store.has(test);
  GoldenResult result = is_compared ? store.settle(test, trace, scenario->tolerances, *mode, settling)
                                    : GoldenResult{true, "", std::nullopt, false};
  compared.in_brief.verdict = verdict_of(result, expectations);
  compared.in_brief.expectations = expectations;
  compared.in_brief.proved = is_proved(trace);
  if (result.comparison) compared.in_brief.first = result.comparison->first;
  if (result.written) {
    fmt::print("{}\n", result.message);
    return {result.passed, std::move(result.message)};
  }
  TestVerdict verdict = check_levels(trace, test, *scenario, options, std::move(result), !settling.violation.empty(),
                                     store, compared.checked);
  if (verdict.passed)
    if (const auto stored = certify(trace, scenario->tolerances); !stored)
      fmt::print(stderr, "{}\n", to_string(stored.errors()));
  return verdict;
}

}  // namespace

TestVerdict match_golden(const Trace& trace, const std::string& test, const MatchOptions& options) {
  const GoldenStore goldens = golden_store();
  report_golden_owner(goldens, test, test, options.source);
  if (const std::string conflict = reported_owners_of(goldens, test).conflict(); !conflict.empty())
    return {false, to_string(error(fmt::format("the golden '{}' isn't this test's alone: {}", test, conflict),
                                   "give each test a name of its own"))};
  const auto folder = RunFolder::make(goldens.where_runs_wait());
  if (!folder) return {false, to_string(folder.errors())};
  WaitingRun waiting(*folder, test);
  GoldenStore store(goldens.folder(), waiting.folder());
  ComparedTest compared;
  TestVerdict verdict = judge(trace, test, options, store, compared);
  if (compared.golden.empty()) return verdict;  // nothing was compared, because the options were wrong
  const auto odd = verdict.passed ? std::nullopt : odd_command_in(trace);
  if (odd && !verdict.message.starts_with(odd->sentence)) verdict.message = odd->sentence + "; " + verdict.message;
  if (compared.checked) {
    compared.in_brief.verdict = compared.checked->verdict;
    compared.in_brief.first = compared.checked->first;
  }
  keep_in_history(test, compared.in_brief, verdict);
  if (!verdict.passed && fs::exists(store.pending_file(test)))
    if (auto kept = store.keep_pending_verdict(test, verdict.message.substr(0, verdict.message.find('\n'))); !kept)
      verdict.message += "\n" + to_string(kept.errors());
  const auto beside = waiting.publish(verdict.message);
  if (!beside) return {false, verdict.message + "\n" + to_string(beside.errors())};
  if (!beside->empty() && !verdict.passed) verdict.message += "\n" + *beside;
  const std::string told = keep_test_report(trace, test, "golden", verdict, compared);
  if (!verdict.passed) verdict.message += told;
  return verdict;
}

TestVerdict hold_expectations(const Trace& trace, const std::string& test) {
  const auto scenario = scenario_in(trace);
  if (!scenario) return {false, to_string(scenario.errors())};
  if (scenario->expectations.empty()) return {false, "the scenario has no expectations: it has no 'expect:'"};
  if (std::string names = unknown_names(*scenario, trace, {}); !names.empty()) return {false, std::move(names)};
  const auto results = judge_expectations(scenario->expectations, trace);
  const std::string violations = violation_lines(results);
  const std::string closest = closest_lines(results);
  if (const std::string one = closest_of(results); !one.empty()) fmt::print("{}\n", one);
  TestVerdict verdict{violations.empty(), violations.empty() ? "" : violations.substr(1) + "\n" + closest};
  ComparedTest compared;
  compared.scenario = scenario_file_of(trace);
  compared.in_brief.verdict = {rehearse::code_of(results), ""};
  compared.in_brief.expectations = results;
  compared.in_brief.proved = is_proved(trace);
  if (const ExpectationResult* violation = first_violation(results))
    compared.in_brief.first = divergence_of(*violation, trace);
  keep_in_history(test + ".expectations", compared.in_brief, verdict);
  const std::string told = keep_test_report(trace, test, "expectations", verdict, compared);
  if (!verdict.passed) verdict.message += told;
  return verdict;
}

}  // namespace rehearse::internal
