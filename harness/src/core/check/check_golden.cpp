// Compares a scenario with the golden that it names, and writes or replaces that golden.
#include <fmt/format.h>
#include <rehearse/compare.h>

#include "base/hashing.h"
#include "check_run.h"
#include "check_verdict.h"
#include "code_of.h"
#include "core/host/odd_command.h"
#include "core/recording/provenance.h"
#include "core/trace/run_facts.h"
#include "proof.h"
#include "unknown_series.h"

namespace rehearse {
namespace fs = std::filesystem;

namespace {

/// Judges a run without a golden, by the expectations of its scenario alone.
Result<CheckReport> check_by_expectations(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                                          const Simulation& simulation) {
  CheckReport report;
  auto run = REHEARSE_TRY(make_run(scenario, actual, options.run, simulation));
  report.run = std::move(run);
  if (ended_before_its_first_tick(*report.run)) {
    tell_early_end(report, actual, LevelState::no_golden);
    return report;
  }
  if (scenario.expectations.empty()) return report;
  report.expectations = REHEARSE_TRY(judge_expectations(scenario.expectations, actual));
  if (auto known = refuse_unknown_series(scenario, report, {actual}); !known) {
    std::error_code ignored;
    fs::remove(actual, ignored);
    return known.errors();
  }
  report.verdict = {code_of(report.expectations), verdict(report.expectations)};
  if (const ExpectationResult* violation = first_violation(report.expectations)) {
    const auto fresh = REHEARSE_TRY(Trace::load_in_pieces(actual, [](const Trace&) {}));
    report.first = divergence_of(*violation, fresh);
    report.message = fmt::format("this run: {}{}", actual.string(), violation_lines(report.expectations));
  }
  return report;
}

/// True if a run that is to become a golden repeats itself. If it doesn't, the reason is in the report.
Result<bool> certify_candidate(const Scenario& scenario, const fs::path& actual, const HostOptions& host,
                               const Simulation& simulation, CheckReport& report) {
  const auto candidate = REHEARSE_TRY(Trace::load(actual));
  const auto found = REHEARSE_TRY(try_reproduction(scenario, candidate, actual, host, simulation));
  if (found.reproduced()) return true;
  report.not_reproduced = true;
  report.verdict = {VerdictCode::golden_not_certified, fmt::format("this run becomes no golden: {}", found.verdict)};
  report.first = found.first;
  report.message = fmt::format("this run: {}", actual.string());
  return false;
}

/// The command that stops in the controller whose failure ended a run, or that commands a number that isn't finite, on
/// its own line. Empty for a refusal, which no tick repeats, and in CI, where a person can't reach the disk.
std::string debugging_advice(const RunSummary& summary, const fs::path& run) {
  const auto odd = summary.ending() ? std::nullopt : odd_command_of(summary);
  if (is_ci() || (!summary.failure && !odd)) return {};
  return fmt::format("\nstop there in gdb: rehearse replay {} --gdb{}", run.string(),
                     odd ? fmt::format(" --tick {}", odd->tick) : "");
}

/// There is no golden yet: the run becomes the golden, or stays pending.
Result<CheckReport> first_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation) {
  const fs::path actual = store.pending_file(scenario.golden);
  auto report = check_by_expectations(scenario, actual, options, simulation);
  if (!report) return report;
  if (const Diagnostic* ending = report->run->ending()) {
    report->closed = LevelState::no_golden;
    report->verdict = {code_of_failure(*report), ending->message};
    report->verdict.add(VerdictCode::golden_missing);
    report->message = fmt::format("this run: {}{}", actual.string(), debugging_advice(*report->run, actual));
    return report;
  }
  const bool violated = !report->within();
  if (mode == GoldenMode::check || violated) {
    report->closed = LevelState::no_golden;
    report->verdict.lead(VerdictCode::golden_missing,
                         fmt::format("there is no golden {}", store.trace_file(scenario.golden).string()));
    if (odd_command_of(*report->run))
      report->message = fmt::format("this run: {}{}{}", actual.string(), violation_lines(report->expectations),
                                    debugging_advice(*report->run, actual));
    else if (!violated)
      report->message =
          fmt::format("this run: {}\n{}", actual.string(), acceptance_advice(scenario.golden, store.folder()));
    tell_odd_command(*report);
    return report;
  }
  auto certified = REHEARSE_TRY(certify_candidate(scenario, actual, options.run, simulation, *report));
  if (!certified) return report;
  REHEARSE_TRY(store.accept_pending(scenario.golden));
  report->golden_written = true;
  report->verdict.lead(VerdictCode::golden_written,
                       fmt::format("wrote the new golden {}", store.trace_file(scenario.golden).string()));
  return report;
}

/// Checks a scenario that names no golden, but has expectations.
Result<CheckReport> check_without_golden(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                                         const Simulation& simulation) {
  auto report = check_by_expectations(scenario, actual, options, simulation);
  std::error_code ignored;
  if (report && report->failed() && report->verdict.code() != to_string(code_of_failure(*report)))
    report->verdict.lead(code_of_failure(*report), report->run->ending()->message);
  if (report && report->failed()) report->message += debugging_advice(*report->run, actual);
  if (report) tell_odd_command(*report);
  if (report && report->within()) fs::remove(actual, ignored);
  return report;
}

/// Accepts a pending run, or adds advice to the report.
Result<void> settle_pending(const Scenario& scenario, GoldenStore& store, GoldenMode mode, const HostOptions& host,
                            const Simulation& simulation, CheckReport& report) {
  const std::string& name = scenario.golden;
  if (report.run && (report.run->ending() || odd_command_of(*report.run))) {
    report.message += debugging_advice(*report.run, store.pending_file(name));
  } else if (first_violation(report.expectations)) {
    report.message += fmt::format("\nif the run is right, correct the expectations in {}", scenario.file);
  } else if (mode == GoldenMode::accept) {
    auto certified = REHEARSE_TRY(certify_candidate(scenario, store.pending_file(name), host, simulation, report));
    if (!certified) return {};
    REHEARSE_TRY(store.accept_pending(name));
    report.golden_written = true;
    report.message = fmt::format("replaced {}", store.trace_file(name).string());
  } else {
    report.message += '\n' + acceptance_advice(name, store.folder());
    if (!report.other_physics.empty() && !report.expectations.empty())
      report.message += "\nits expectations hold: rehearse golden accept --all makes every run that waits a golden";
  }
  return {};
}

/// Compares a golden with its digest. Files that agreed before, according to the same programs, agree now.
Result<void> check_digest(const Scenario& scenario, const GoldenStore& store,
                          const std::optional<fs::path>& certificates) {
  const auto golden = hash_of_file(store.trace_file(scenario.golden));
  const auto digest = hash_of_file(store.digest_file(scenario.golden));
  const std::string programs = stated(provenance(scenario, nullptr, "", ""), facts::programs);
  if (!certificates || !golden || !digest || programs.empty()) return store.check_digest(scenario.golden);
  const Certificates known(*certificates, "digest-" + hash_text(*golden));
  const std::string agreement = fmt::format("digest: {}\nprograms: {}\n", hash_text(*digest), programs);
  if (known.has(agreement)) return {};
  REHEARSE_TRY(store.check_digest(scenario.golden));
  (void)known.add(agreement);  // without the certificate, the next check reads both files again
  return {};
}

/// The errors, of which those of the golden's file name the way back.
Diagnostics with_way_back(Diagnostics errors, const fs::path& golden) {
  for (Diagnostic& problem : errors)
    if (problem.file == golden.string() && problem.hint.empty()) problem.hint = way_back(golden.string());
  return errors;
}

}  // namespace

Result<CheckReport> check_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation) {
  const std::string& name = scenario.golden;
  if (name.empty() && options.closed && !scenario.expectations.empty())
    return check_without_golden(scenario, store.pending_file(scenario.name), options, simulation);
  if (name.empty())
    return error_in(scenario.file, "the scenario names no golden to compare with, and has no expectations",
                    "golden: Suite.Test, or expect: with the conditions of a run");
  if (!store.has(name)) return first_golden(scenario, store, mode, options, simulation);
  const fs::path actual = store.pending_file(name);
  auto report = check_scenario(scenario, store.trace_file(name), actual, options, simulation);
  if (!report) return with_way_back(report.errors(), store.trace_file(name));
  if (options.closed && !report->within()) {
    REHEARSE_TRY(store.keep_pending_verdict(name, report->verdict.text()));
    REHEARSE_TRY(settle_pending(scenario, store, mode, options.run, simulation, *report));
  } else if (const auto digest = check_digest(scenario, store, options.certificates); !digest) {
    if (mode != GoldenMode::accept) return digest.errors();
    REHEARSE_TRY(store.accept(name, store.trace_file(name)));
  }
  return report;
}

}  // namespace rehearse
