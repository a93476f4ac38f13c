#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/compare.h>

#include <algorithm>

#include "base/clock.h"
#include "base/hashing.h"
#include "blame.h"
#include "check_run.h"
#include "code_of.h"
#include "core/compare/compare_structure.h"
#include "core/compare/compared_files.h"
#include "core/compare/scenario_changes.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "core/recording/provenance.h"
#include "core/replay/plant_level.h"
#include "core/scenario/branch_origin.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "expectation_judge.h"
#include "noise_floor.h"
#include "own_run.h"
#include "proof.h"
#include "unknown_series.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

LevelState state_of(const Comparison& comparison) {
  if (comparison.equal) return LevelState::equal;
  return comparison.within ? LevelState::within : LevelState::differs;
}

/// Reads the whole recording, to find its damage and its events.
Result<Trace> load_without_messages(const fs::path& file) {
  return Trace::load_in_pieces(file, [](const Trace&) {});
}

/// Reads the events and commands of a golden: a run that begins at one of its checkpoints needs no more of it. The CRC
/// of its data section covers the rest.
Result<Trace> load_commands(const fs::path& golden) {
  const auto wanted = [](const mcap::Channel& channel) {
    const ChannelName name = ChannelName::parse(channel.topic);
    return name.kind == ChannelKind::events || name.side == ChannelSide::output || name.side == ChannelSide::acted;
  };
  return load_pieces(
      golden, wanted, [](const Trace&) {}, Trace::usual_piece_size, PieceOrder::of_file);
}

/// One check under way.
struct Check {
  const Scenario& scenario;
  const Trace& golden;  // without messages
  fs::path actual;
  const CheckOptions& options;
  const Simulation& simulation;
  CheckReport report;
  bool world_is_known = false;                       // it makes the golden under the golden's commands
  std::optional<NoiseFloor> noise = std::nullopt;    // the measured noise of the golden
  std::optional<Trace> whole_golden = std::nullopt;  // if its noise was measured: for the hash of its numbers

  fs::path plant_trace() const { return actual.parent_path() / "plant" / actual.filename(); }
  Result<void> check_controller();
  Result<void> check_proved(const Proof& proof);
  Result<void> tell_unmatched_rules(const Proof& proof);
  Result<void> certify(const Proof& proof);
  Result<void> make_closed_loop();
  Result<void> simulate();
  Result<void> check_plant();
  Result<void> check_closed();
  void blame();
  Result<void> test_reproduction();
  Result<void> tell_time_step(const Divergence& change);
  void tell_duration(const Divergence& change, const Trace& fresh);
  void judge_by_expectations(const Trace& fresh);
  Result<void> find_noise();
  void judge_tolerances();
  void tell_files(const Trace& fresh, const Comparison& comparison, const fs::path& file, const char* what);
};

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

/// Without a simulation: it is proved that the world makes the golden. Levels that remain unproved are simulated later.
Result<void> Check::check_proved(const Proof& proof) {
  if (options.plant) report.plant = LevelState::proved;
  if (options.controller || options.closed) REHEARSE_TRY(check_controller());
  const bool repeats = report.replay && report.replay->repeats_the_run;
  std::vector<ExpectationResult> results;
  if (options.closed && repeats) {
    auto judged = REHEARSE_TRY(judge_expectations(scenario.expectations, golden.file()));
    results = std::move(judged);
  }
  report.proved = (repeats || (!options.controller && !options.closed)) && !first_violation(results);
  if (!options.controller) {  // not requested
    report.controller = LevelState::not_compared;
    report.replay.reset();
    report.controller_problem.clear();
  }
  if (!report.proved) return {};
  REHEARSE_TRY(tell_unmatched_rules(proof));
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

/// Adds a remark for each tolerance that applies to nothing in the golden, which is the run. The whole golden has to be
/// read for its names. So a second kind of certificate states the rules, and those of them that apply to nothing.
Result<void> Check::tell_unmatched_rules(const Proof& proof) {
  if (scenario.tolerances.empty()) return {};
  const auto unmatched_line = [](const ToleranceRule& rule) { return fmt::format("\nunmatched: {}\n", rule.channel); };
  std::string rules;
  for (const ToleranceRule& rule : scenario.tolerances) rules += fmt::format("rule: {}\n", rule.channel);
  rules += "end of rules\n";
  const Certificates surveyed(*options.certificates, "rules-" + hash_text(proof.golden_hash()));
  std::string facts;
  for (std::string& stated : surveyed.all())
    if (stated.starts_with(rules)) facts = std::move(stated);
  if (facts.empty()) {
    const auto whole = REHEARSE_TRY(load_without_messages(golden.file()));
    const Trace* traces[] = {&whole};
    facts = rules;
    for (const ToleranceRule& rule : scenario.tolerances)
      if (!unmatched_rules({rule}, traces).empty()) facts += unmatched_line(rule);
    REHEARSE_TRY(surveyed.add(facts));
  }
  for (const ToleranceRule& rule : scenario.tolerances)
    if (facts.find(unmatched_line(rule)) != std::string::npos)
      report.remarks.push_back(to_string(applies_to_nothing(rule)));
  return {};
}

/// Stores a certificate if every bit of the golden was compared and is equal.
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
  auto level = compare_plant(simulation, scenario, golden, file, running,
                             noise ? noise_of_series(*noise, *whole_golden) : NoiseOfSeries());
  report.plant = LevelState::differs;
  if (!level) {
    report.plant_problem = level.errors()[0].message;
    return {};
  }
  report.plant = state_of(level->comparison);
  if (report.plant == LevelState::differs) {
    tell_files(level->trace, level->comparison, file, "the golden's commands in this world");
  } else {
    std::error_code ignored;
    fs::remove(file, ignored);
    remove_picture_differences(file);
  }
  report.plant_run = std::move(level->run);
  report.plant_comparison = std::move(level->comparison);
  return {};
}

Result<void> Check::check_closed() {
  const std::optional<double> measured = whole_golden ? estimated_horizon(*whole_golden) : std::nullopt;
  report.horizon = horizon_of(scenario, options.estimated_horizon ? options.estimated_horizon : measured);
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
  auto judged = REHEARSE_TRY(compares_samples || judge.needs_order() ? judge_expectations(scenario.expectations, actual)
                                                                     : judge.finish(fresh));
  report.expectations = std::move(judged);
  if (report.closed == LevelState::differs || first_violation(report.expectations))
    tell_files(fresh, *report.comparison, actual, "this run");
  blame();
  REHEARSE_TRY(test_reproduction());
  if (report.not_reproduced) tell_files(fresh, *report.comparison, actual, "this run");
  if (duration) tell_duration(*duration, fresh);
  judge_by_expectations(fresh);
  return {};
}

/// Reports a changed time step. No tick is compared, but the run may become the next golden, so its expectations are
/// judged.
Result<void> Check::tell_time_step(const Divergence& change) {
  report.verdict = {VerdictCode::time_step_changed,
                    fmt::format("the scenario's time step changed: it is {} s, and the golden's {} s; nothing was "
                                "compared",
                                change.actual, change.expected)};
  report.first = change;
  report.other_duration = true;
  if (!options.closed) return {};
  const auto fresh = REHEARSE_TRY(load_without_messages(actual));
  report.message = fmt::format("this run: {}", actual.string());
  auto judged = REHEARSE_TRY(judge_expectations(scenario.expectations, actual));
  report.expectations = std::move(judged);
  judge_by_expectations(fresh);
  return {};
}

/// Reports a changed duration. The runs were compared up to the end of the shorter one.
void Check::tell_duration(const Divergence& change, const Trace& fresh) {
  std::string sentence =
      fmt::format("the scenario's duration changed: it is {} s, and the golden's {} s", change.actual, change.expected);
  const bool is_alone = !any_level_differs(report) && !report.not_reproduced;
  if (!is_alone) return report.verdict.add(VerdictCode::duration_changed, "besides, " + sentence);
  report.verdict.lead(VerdictCode::duration_changed, std::move(sentence));
  report.first = change;
  report.other_duration = true;
  tell_files(fresh, *report.comparison, actual, "this run");
}

/// Tests whether a run within tolerance repeats itself. Tolerances allow for changes. If nothing changed, or if a run
/// doesn't repeat itself, different bits are chance, and a golden that is met by chance proves nothing.
Result<void> Check::test_reproduction() {
  if (report.closed != LevelState::within || report.comparison->words_alone) return {};
  const auto fresh = REHEARSE_TRY(Trace::load(actual));
  auto found = REHEARSE_TRY(try_reproduction(scenario, fresh, actual, options.run, simulation));
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

/// Adds the expectations to the verdict. A run that is within tolerance, or was not compared, may violate them.
void Check::judge_by_expectations(const Trace& fresh) {
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

void Check::tell_files(const Trace& fresh, const Comparison& comparison, const fs::path& file, const char* what) {
  report.message +=
      fmt::format("{}{}: {}{}", report.message.empty() ? "" : "\n", what, file.string(),
                  picture_lines(write_picture_differences(golden, fresh, comparison, scenario.tolerances, file)));
}

/// Sets the verdict that names the part that changed.
void Check::blame() {
  const Suspects suspects{
      scenario, golden, simulation, with_controllers_of(scenario, options.run), actual, plant_trace().concat(".again")};
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

/// Loads the measured noise of the golden. A golden without a measurement is valid.
Result<void> Check::find_noise() {
  const fs::path file = noise_file_of(golden.file());
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  auto whole = REHEARSE_TRY(Trace::load(golden.file()));
  whole_golden = std::move(whole);
  auto found = load_noise_floor(file);
  if (found)
    noise = *std::move(found);
  else
    report.remarks.push_back("the measured noise can't be read: " + to_string(found.errors()[0]));
  return {};
}

/// Adds remarks on tolerances that don't agree with the measured noise.
void Check::judge_tolerances() {
  if (!noise) return;
  std::vector<const Comparison*> comparisons;
  if (report.plant_comparison) comparisons.push_back(&*report.plant_comparison);
  if (report.comparison) comparisons.push_back(&*report.comparison);
  for (std::string& remark : noise_remarks(*noise, *whole_golden, comparisons))
    report.remarks.push_back(std::move(remark));
  if (scenario.horizon && noise->horizon() && *scenario.horizon >= *noise->horizon())
    report.remarks.push_back(
        fmt::format("the scenario's horizon, {:g} s, is not before {:g} s, when a perturbed run left the "
                    "tolerances",
                    *scenario.horizon, *noise->horizon()));
}

Result<void> Check::make_closed_loop() {
  auto run = REHEARSE_TRY(make_run(scenario, golden, world_is_known && report.replay ? &*report.replay : nullptr,
                                   actual, options.run, simulation));
  report.simulated_from = run.from;
  report.run = std::move(run.summary);
  return {};
}

/// Makes the levels that aren't proved.
Result<void> Check::simulate() {
  REHEARSE_TRY(find_noise());
  if (options.closed) REHEARSE_TRY(make_closed_loop());
  if (const auto change = changed_time_step(scenario, golden)) return tell_time_step(*change);
  if (options.controller && report.controller == LevelState::not_compared) REHEARSE_TRY(check_controller());
  if (options.plant && report.plant == LevelState::not_compared) REHEARSE_TRY(check_plant());
  if (options.closed) {
    REHEARSE_TRY(check_closed());
  } else {
    blame();
  }
  judge_tolerances();
  return {};
}

/// The reason why the golden's world can't be simulated again: then only its controllers can be checked. Empty: it can
/// be simulated again.
std::string why_no_world(const Trace& golden) {
  const RunFacts run = RunFacts::of(golden);
  if (run.is_of_log) return "the golden was recorded from a log: there is no physics to repeat";
  const std::optional<BranchOrigin>& origin = run.branch;
  if (origin && !origin->simulated) return "the golden is a replay: its world didn't follow its commands";
  if (origin && !origin->set.empty())
    return "the golden is a branch with altered inputs: a simulation doesn't make them again";
  return {};
}

/// Adds the pushes of a branch to those of its scenario.
Result<Scenario> with_pushes_of(const std::optional<BranchOrigin>& origin, Scenario scenario) {
  if (!origin) return scenario;
  for (const std::string& text : origin->push) {
    const auto push = REHEARSE_TRY(parse_push(text, scenario));
    scenario.pushes.push_back(push);
  }
  return scenario;
}

/// Leaves out the levels that the golden can't have.
void leave_out_levels(const Trace& golden, CheckOptions& options, CheckReport& report) {
  const auto origin = RunFacts::of(golden).branch;
  if (const std::string why = why_no_world(golden); !why.empty()) {
    options.plant = options.closed = false;
    report.remarks.push_back(why + ", so the levels plant and closed are not compared");
  } else if (origin && origin->acted_until) {
    options.closed = false;
    report.remarks.push_back(
        fmt::format("the golden is a branch: until tick {} other controllers moved its world, so the "
                    "level closed is not compared",
                    *origin->acted_until));
  }
}

void remove_run_of(const fs::path& actual) {
  std::error_code ignored;
  fs::remove(actual, ignored);
  remove_picture_differences(actual);
}

/// Simulates a share of the proved checks as well.
Result<CheckReport> sampled(Check check) {
  const auto chosen = REHEARSE_TRY(is_sampled(check.scenario.name, check.options.sampled));
  if (!chosen) return std::move(check.report);
  CheckOptions simulating = check.options;
  simulating.certificates.reset();
  auto again = check_scenario(check.scenario, check.golden.file(), check.actual, simulating, check.simulation);
  if (!again) return again;
  if (again->equal()) return std::move(check.report);
  again->verdict.lead(
      VerdictCode::proof_wrong,
      "the proof was wrong: it found no change since the golden, but the simulation has another result");
  again->proof_was_wrong = true;
  return again;
}

}  // namespace

Result<CheckReport> check_scenario(const Scenario& plain, const fs::path& golden, const fs::path& actual,
                                   const CheckOptions& asked, const Simulation& given) {
  Simulation simulation = given;
  simulation.run_plant = own_plant(std::move(simulation.run_plant));
  const auto outline = Trace::outline(golden);
  if (!outline) {  // a pass over the whole file finds the damage
    const auto whole = load_without_messages(golden);
    return whole ? outline.errors() : whole.errors();
  }
  REHEARSE_TRY(check_version(*outline));
  const auto pushed = REHEARSE_TRY(with_pushes_of(RunFacts::of(*outline).branch, plain));
  const Scenario& scenario = pushed;
  CheckOptions options = asked;
  Check proving{scenario, *outline, actual, options, simulation, {}};
  leave_out_levels(*outline, options, proving.report);
  const Proof proof(scenario, *outline, options, simulation);
  if (proof.holds()) REHEARSE_TRY(proving.check_proved(proof));
  if (proving.report.proved) {
    REHEARSE_TRY(refuse_unknown_series(scenario, proving.report, {golden}));
    return sampled(std::move(proving));
  }

  const auto expected = REHEARSE_TRY(proof.holds() ? load_commands(golden) : load_without_messages(golden));
  Check check{scenario, expected, actual, options, simulation, std::move(proving.report)};
  check.report.not_proved = proof.objection();
  check.world_is_known = proof.holds();
  REHEARSE_TRY(check.simulate());
  if (check.report.failed()) check.report.verdict.lead(code_of_failure(check.report));
  if (auto known = refuse_unknown_series(scenario, check.report, {golden, actual}); !known) {
    remove_run_of(actual);
    return known.errors();
  }
  REHEARSE_TRY(check.certify(proof));
  if (check.report.within()) remove_run_of(actual);
  return std::move(check.report);
}

}  // namespace rehearse
