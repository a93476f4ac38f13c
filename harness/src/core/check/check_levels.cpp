#include "check_levels.h"

#include <fmt/format.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/hashing.h"
#include "check_run.h"
#include "check_verdict.h"
#include "code_of.h"
#include "core/compare/compare_structure.h"
#include "core/compare/compared_files.h"
#include "core/compare/scenario_changes.h"
#include "core/replay/plant_level.h"
#include "core/trace/run_facts.h"
#include "expectation_judge.h"
#include "other_physics.h"
#include "unmatched_rules.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

void remove_run(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
  remove_picture_differences(file);
}

LevelState state_of(const Comparison& comparison) {
  if (comparison.equal) return LevelState::equal;
  return comparison.within ? LevelState::within : LevelState::differs;
}

}  // namespace

Result<Trace> load_without_messages(const fs::path& file) {
  return Trace::load_in_pieces(file, [](const Trace&) {});
}

Result<void> Check::check_controller() {
  if (report.controller_problem = changed_controllers(scenario, golden); !report.controller_problem.empty()) {
    report.controller = LevelState::differs;
    return {};
  }
  auto replayed = replay_golden(scenario, golden, with_controllers_of(scenario, options.run));
  if (!replayed && !options.closed) return replayed.errors();
  report.controller = LevelState::differs;
  if (!replayed) {
    report.controller_problem = replayed.errors()[0].message;
    return {};
  }
  report.controller = replayed->state;
  report.replay = std::move(replayed->replay);
  if (report.replay->is_allowed())
    report.remarks.push_back(
        headline(*report.replay, "the rules for commands allow the differences: fed with the golden's inputs, "));
  return {};
}

Result<void> Check::check_proved(const Proof& proof) {
  if (options.plant) report.plant = LevelState::proved;
  if (options.controller || options.closed) REHEARSE_TRY(check_controller());
  const bool repeats = report.replay && report.replay->repeats_the_run;
  std::vector<ExpectationResult> results;
  if (options.closed && repeats) results = REHEARSE_TRY(judge_expectations(scenario.expectations, golden.file()));
  report.proved = (repeats || (!options.controller && !options.closed)) && !first_violation(results);
  if (!options.controller) {  // not requested
    report.controller = LevelState::not_compared;
    report.replay.reset();
    report.controller_problem.clear();
  }
  if (!report.proved) return {};
  const Certificates answers(*options.certificates, "rules-" + hash_text(proof.golden_hash()));
  const auto unmatched = REHEARSE_TRY(unmatched_rule_remarks(scenario.tolerances, golden, answers));
  report.remarks.insert(report.remarks.end(), unmatched.begin(), unmatched.end());
  report.expectations = std::move(results);
  if (options.closed) report.closed = LevelState::proved;
  report.verdict = {VerdictCode::same,
                    options.closed || options.controller
                        ? "proved without simulating: the world is the one that made the golden, and the controllers "
                          "repeat its commands"
                        : "proved without simulating: the world is the one that made the golden"};
  if (!report.expectations.empty()) report.verdict.add(code_of(report.expectations), verdict(report.expectations));
  return {};
}

Result<void> Check::certify(const Proof& proof) {
  const bool is_equal = report.closed == LevelState::equal && report.controller != LevelState::differs;
  if (!is_equal || report.run->ending()) return {};
  if (report.horizon) {  // only the time before the horizon was compared
    const auto compared = REHEARSE_TRY(compare(golden.file(), actual, scenario.tolerances, {}));
    if (!compared.equal) return {};
  }
  if (auto stored = proof.certify(); !stored) report.remarks.push_back(stored.errors()[0].message);
  return {};
}

Result<void> Check::check_plant() {
  const fs::path file = plant_trace();
  PlantOptions running;
  running.progress = options.run.progress;
  auto level = compare_plant(simulation, scenario, golden, file, running, noise.of_series());
  report.plant = LevelState::differs;
  if (!level) {
    report.plant_problem = level.errors()[0].message;
    return {};
  }
  report.plant = state_of(level->comparison);
  if (report.plant == LevelState::differs && is_of_other_physics(level->trace, level->comparison)) {
    report.plant = LevelState::not_compared;
    remove_run(file);
    return {};
  }
  if (report.plant == LevelState::differs) {
    tell_files(level->trace, level->comparison, file, "the golden's commands in this world");
  } else {
    remove_run(file);
  }
  report.plant_run = std::move(level->run);
  report.plant_comparison = std::move(level->comparison);
  return {};
}

Result<void> Check::make_closed_loop() {
  auto run = REHEARSE_TRY(make_run(scenario, golden, world_is_known && report.replay ? &*report.replay : nullptr,
                                   actual, options.run, simulation));
  report.simulated_from = run.from;
  report.run = std::move(run.summary);
  return {};
}

Result<void> Check::check_closed() {
  report.horizon =
      horizon_of(scenario, options.estimated_horizon ? options.estimated_horizon : noise.estimated_horizon());
  const auto duration = changed_duration(scenario, golden);
  if (duration) report.horizon = std::min(duration->time, report.horizon.value_or(duration->time));
  CompareOptions what;
  what.until = report.horizon;
  ExpectationJudge judge(scenario.expectations);
  auto compared =
      REHEARSE_TRY(compare_files(golden.file(), actual, scenario.tolerances, what, [&judge](const Trace& piece) {
        if (!judge.needs_order()) judge.take(piece);
      }));
  report.comparison = std::move(compared.comparison);
  report.remarks.insert(report.remarks.end(), report.comparison->not_compared.begin(),
                        report.comparison->not_compared.end());
  const Trace& fresh = compared.actual;
  report.closed = state_of(*report.comparison);
  const bool compares_samples = RunFacts::of(golden).state_rate.has_value();
  report.expectations =
      REHEARSE_TRY(compares_samples || judge.needs_order() ? judge_expectations(scenario.expectations, actual)
                                                           : judge.finish(fresh));
  const bool is_moved = report.closed == LevelState::differs && report.comparison->first->stage != Stage::costs;
  if (is_moved && is_of_other_physics(fresh, *report.comparison)) {
    report.closed = LevelState::not_compared;
    report.comparison.reset();
    report.message = fmt::format("this run: {}", actual.string());
  } else if (report.closed == LevelState::differs || first_violation(report.expectations)) {
    tell_files(fresh, *report.comparison, actual, "this run");
  }
  blame(*this);
  REHEARSE_TRY(test_reproduction(*this));
  if (report.not_reproduced) tell_files(fresh, *report.comparison, actual, "this run");
  if (duration) tell_duration(*this, *duration, fresh);
  judge_by_expectations(*this, fresh);
  return {};
}

Result<void> Check::simulate() {
  noise = REHEARSE_TRY(GoldenNoise::of(golden, report.remarks));
  if (options.closed) REHEARSE_TRY(make_closed_loop());
  if (report.run && ended_before_its_first_tick(*report.run)) {
    tell_early_end(report, actual, LevelState::differs);
    return {};
  }
  if (const auto change = changed_time_step(scenario, golden)) return tell_time_step(*this, *change);
  if (options.controller && report.controller == LevelState::not_compared) REHEARSE_TRY(check_controller());
  if (options.plant && report.plant == LevelState::not_compared) REHEARSE_TRY(check_plant());
  if (options.closed) {
    REHEARSE_TRY(check_closed());
  } else {
    blame(*this);
  }
  noise.judge_tolerances(scenario, report);
  return {};
}

bool Check::is_of_other_physics(const Trace& fresh, const Comparison& comparison) {
  report.other_physics = other_physics(scenario, golden, fresh, comparison.changed_files);
  return !report.other_physics.empty();
}

void Check::tell_files(const Trace& fresh, const Comparison& comparison, const fs::path& file, const char* what) {
  report.message +=
      fmt::format("{}{}: {}{}", report.message.empty() ? "" : "\n", what, file.string(),
                  picture_lines(write_picture_differences(golden, fresh, comparison, scenario.tolerances, file)));
}

}  // namespace rehearse
