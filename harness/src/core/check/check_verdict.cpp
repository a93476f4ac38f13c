#include "check_verdict.h"

#include <fmt/format.h>
#include <rehearse/compare.h>

#include <string>
#include <utility>
#include <vector>

#include "blame.h"
#include "check_run.h"
#include "code_of.h"
#include "core/compare/compare_structure.h"
#include "core/host/odd_command.h"
#include "core/trace/trace_windows.h"
#include "expectation_judge.h"

namespace rehearse {

void blame(Check& check) {
  CheckReport& report = check.report;
  const Suspects suspects{check.scenario,   check.golden,
                          check.simulation, with_controllers_of(check.scenario, check.options.run),
                          check.actual,     check.plant_trace().concat(".again")};
  compare_other_levels(suspects, report);
  const Blame found = find_guilty(suspects, report);
  report.verdict = found.verdict;
  report.first = found.place;
  report.first_bit = found.bit;
  const std::vector<std::string> other_inputs = report.replay       ? report.replay->other_inputs
                                                : report.comparison ? report.comparison->other_inputs
                                                                    : std::vector<std::string>();
  if (!other_inputs.empty() && !found.is_of_structure) {
    std::string sentence = other_inputs_sentence(other_inputs);
    if (any_level_differs(report))
      report.verdict.add(VerdictCode::controller_inputs_changed, std::move(sentence));
    else
      report.verdict.lead(VerdictCode::controller_inputs_changed, std::move(sentence));
  }
  if (report.first || !report.comparison) return;
  report.first = report.comparison->first;  // a part that couldn't be compared alone has no place
  if (report.first && !report.controller_problem.empty()) report.first->stage = Stage::controller;
}

Result<void> tell_time_step(Check& check, const Divergence& change) {
  CheckReport& report = check.report;
  report.verdict = {VerdictCode::time_step_changed,
                    fmt::format("the scenario's time step changed: it is {} s, and the golden's {} s; nothing was "
                                "compared",
                                change.actual, change.expected)};
  report.first = change;
  report.other_duration = true;
  if (!check.options.closed) return {};
  const auto fresh = REHEARSE_TRY(load_without_messages(check.actual));
  report.message = fmt::format("this run: {}", check.actual.string());
  report.expectations = REHEARSE_TRY(judge_expectations(check.scenario.expectations, check.actual));
  judge_by_expectations(check, fresh);
  return {};
}

void tell_duration(Check& check, const Divergence& change, const Trace& fresh) {
  CheckReport& report = check.report;
  std::string sentence =
      fmt::format("the scenario's duration changed: it is {} s, and the golden's {} s", change.actual, change.expected);
  const bool is_alone = !any_level_differs(report) && !report.not_reproduced && report.other_physics.empty();
  if (!is_alone) return report.verdict.add(VerdictCode::duration_changed, "besides, " + sentence);
  report.verdict.lead(VerdictCode::duration_changed, std::move(sentence));
  report.first = change;
  report.other_duration = true;
  check.tell_files(fresh, *report.comparison, check.actual, "this run");
}

Result<void> test_reproduction(Check& check) {
  CheckReport& report = check.report;
  if (report.closed != LevelState::within || report.comparison->words_alone) return {};
  const auto fresh = REHEARSE_TRY(Trace::load(check.actual));
  auto found = REHEARSE_TRY(try_reproduction(check.scenario, fresh, check.actual, check.options.run, check.simulation));
  const Divergence& bit = *report.comparison->first_bit;
  if (found.reproduced() && !report.comparison->same_origin) return {};
  report.not_reproduced = true;
  report.verdict = {
      VerdictCode::golden_not_certified,
      "the golden isn't certified, though this run is within its tolerances: " +
          (found.reproduced() ? "it states the same programs, files and controllers, but this run, which repeats "
                                "itself, has different bits: " +
                                    to_string(bit)
                              : found.verdict)};
  report.first = found.first ? found.first : bit;
  return {};
}

void judge_by_expectations(Check& check, const Trace& fresh) {
  CheckReport& report = check.report;
  if (report.expectations.empty()) return;
  std::string judged = verdict(report.expectations);
  const ExpectationResult* violation = first_violation(report.expectations);
  const bool is_alone = violation && !any_level_differs(report) && !report.not_reproduced && !report.other_duration;
  const bool failed = report.run && report.run->ending();
  // a run that a controller ended violates expectations because of that
  if (violation && !failed)
    report.verdict.lead(code_of(report.expectations), std::move(judged));
  else
    report.verdict.add(code_of(report.expectations), std::move(judged));
  if (is_alone) report.first = divergence_of(*violation, fresh);
  report.message += violation_lines(report.expectations);
}

bool ended_before_its_first_tick(const RunSummary& run) { return run.ending() && run.ticks == 0; }

void tell_early_end(CheckReport& report, const std::filesystem::path& actual, LevelState closed) {
  report.closed = closed;
  report.verdict = {code_of_failure(report), report.run->ending()->message};
  report.message = fmt::format("this run: {}", actual.string());
}

void tell_odd_command(CheckReport& report) {
  if (!report.run || report.within() || report.failed()) return;
  const auto odd = odd_command_of(*report.run);
  if (odd && report.verdict.code() != to_string(VerdictCode::controller_not_finite))
    report.verdict.lead(VerdictCode::controller_not_finite, odd->sentence);
}

}  // namespace rehearse
