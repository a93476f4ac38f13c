#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/compare.h>

#include <algorithm>

#include "blame.h"
#include "check_run.h"
#include "compare/scenario_changes.h"
#include "model/clock.h"
#include "noise_floor.h"
#include "recording/provenance.h"
#include "replay/plant_level.h"
#include "scenario/branch_origin.h"
#include "trace/run_facts.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

LevelState state_of(const Comparison& comparison) {
  if (comparison.equal) return LevelState::equal;
  return comparison.within ? LevelState::within : LevelState::differs;
}

/// Reads all of it for its damage, and its events.
Result<Trace> load_without_messages(const fs::path& file) {
  return Trace::load_in_pieces(file, [](const Trace&) {});
}

/// One check under way.
struct Check {
  const Scenario& scenario;
  const Trace& golden;  // without messages
  fs::path actual;
  const CheckOptions& options;
  const Simulation& simulation;
  CheckReport report;
  std::optional<NoiseFloor> noise = std::nullopt;    // that was measured of the golden
  std::optional<Trace> whole_golden = std::nullopt;  // if noise was measured of it: it is known by all of its numbers

  fs::path plant_trace() const { return actual.parent_path() / "plant" / actual.filename(); }
  Result<void> check_controller();
  Result<void> check_plant();
  Result<void> check_closed();
  void blame();
  Result<void> certify();
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
  report.controller = state_of(*replayed);
  report.replay = *std::move(replayed);
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
  const auto fresh = load_without_messages(actual);
  if (!fresh) return fresh.errors();
  const std::optional<double> measured = whole_golden ? estimated_horizon(*whole_golden) : std::nullopt;
  report.horizon = horizon_of(scenario, options.estimated_horizon ? options.estimated_horizon : measured);
  const auto duration = changed_duration(scenario, golden);
  if (duration) report.horizon = std::min(duration->time, report.horizon.value_or(duration->time));
  CompareOptions what;
  what.until = report.horizon;
  auto compared = compare(golden.file(), actual, scenario.tolerances, what);
  if (!compared) return compared.errors();
  report.comparison = *std::move(compared);
  report.closed = state_of(*report.comparison);
  auto judged = judge_expectations(scenario.expectations, actual);
  if (!judged) return judged.errors();
  report.expectations = *std::move(judged);
  if (report.closed == LevelState::differs || first_violation(report.expectations))
    tell_files(*fresh, *report.comparison, actual, "this run");
  blame();
  if (auto done = certify(); !done) return done;
  if (report.not_reproduced) tell_files(*fresh, *report.comparison, actual, "this run");
  if (duration) tell_duration(*duration, *fresh);
  judge_by_expectations(*fresh);
  return {};
}

/// No tick is compared; but the run may become the next golden, and is judged by what is expected of it.
Result<void> Check::tell_time_step(const Divergence& change) {
  report.verdict = fmt::format("the scenario's time step changed: it is {} s, and the golden's {} s; nothing was compared",
                               change.actual, change.expected);
  report.first = change;
  (options.closed ? report.closed : options.plant ? report.plant : report.controller) = LevelState::differs;
  if (!options.closed) return {};
  const auto fresh = load_without_messages(actual);
  if (!fresh) return fresh.errors();
  report.message = fmt::format("this run: {}", actual.string());
  auto judged = judge_expectations(scenario.expectations, actual);
  if (!judged) return judged.errors();
  report.expectations = *std::move(judged);
  judge_by_expectations(*fresh);
  return {};
}

/// The runs were compared up to the end of the shorter one.
void Check::tell_duration(const Divergence& change, const Trace& fresh) {
  const std::string sentence =
      fmt::format("the scenario's duration changed: it is {} s, and the golden's {} s", change.actual, change.expected);
  const bool is_alone = report.within();
  report.verdict = is_alone ? sentence + "; " + report.verdict : report.verdict + "; besides, " + sentence;
  if (!is_alone) return;
  report.first = change;
  report.closed = LevelState::differs;
  tell_files(fresh, *report.comparison, actual, "this run");
}

/// Tolerances are for what changed. Where nothing did, or where a run doesn't repeat itself, other bits are chance, and
/// a golden that is met by chance certifies nothing.
Result<void> Check::certify() {
  if (report.closed != LevelState::within || report.comparison->words_alone) return {};
  const auto fresh = Trace::load(actual);
  if (!fresh) return fresh.errors();
  auto found = try_reproduction(scenario, *fresh, actual, options.run, simulation);
  if (!found) return found.errors();
  const Divergence& bit = *report.comparison->first_bit;
  if (!found->reproduced()) {
    report.verdict = fmt::format("the golden isn't certified, though this run is within its tolerances: {}", found->verdict);
    report.first = found->first ? found->first : bit;
  } else if (report.comparison->same_origin) {
    report.verdict = fmt::format(
        "the golden isn't certified, though this run is within its tolerances: it names these very programs, files and "
        "controllers, and yet this run, which repeats itself, isn't the golden's, bit for bit: {}",
        to_string(bit));
    report.first = bit;
  } else {
    return {};
  }
  report.not_reproduced = true;
  report.closed = LevelState::differs;
  return {};
}

/// What the comparison left open, or found right, may be wrong all the same.
void Check::judge_by_expectations(const Trace& fresh) {
  if (report.expectations.empty()) return;
  const std::string judged = verdict(report.expectations);
  const ExpectationResult* violation = first_violation(report.expectations);
  const bool is_alone = violation && report.within();
  const bool failed = report.run && report.run->ending();
  // a run that a controller ended is not as expected because of that
  report.verdict = violation && !failed ? judged + "; " + report.verdict : report.verdict + "; " + judged;
  if (is_alone) report.first = divergence_of(*violation, fresh);
  if (violation) report.closed = LevelState::differs;
  report.message += violation_lines(report.expectations);
}

void Check::tell_files(const Trace& fresh, const Comparison& comparison, const fs::path& file, const char* what) {
  report.message += fmt::format(
      "{}{}: {}{}", report.message.empty() ? "" : "\n", what, file.string(),
      picture_lines(write_picture_differences(golden, fresh, comparison, scenario.tolerances, file)));
}

/// Names the part that changed.
void Check::blame() {
  const Blame found = find_guilty(
      {scenario, golden, simulation, with_controllers_of(scenario, options.run), actual, plant_trace().concat(".again")}, report);
  report.verdict = found.sentence;
  report.first = found.place;
  if (report.first || !report.comparison) return;
  report.first = report.comparison->first;  // a part that couldn't be tried alone has no place of its own
  if (report.first && !report.controller_problem.empty()) report.first->stage = Stage::controller;
}

/// A golden without a measurement is fine.
Result<void> Check::find_noise() {
  const fs::path file = noise_file_of(golden.file());
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  auto whole = Trace::load(golden.file());
  if (!whole) return whole.errors();
  whole_golden = *std::move(whole);
  auto found = load_noise_floor(file);
  if (found)
    noise = *std::move(found);
  else
    report.remarks.push_back("the measured noise can't be read: " + to_string(found.errors()[0]));
  return {};
}

/// What the noise says of the tolerances.
void Check::judge_tolerances() {
  if (!noise) return;
  std::vector<const Comparison*> comparisons;
  if (report.plant_comparison) comparisons.push_back(&*report.plant_comparison);
  if (report.comparison) comparisons.push_back(&*report.comparison);
  for (std::string& remark : noise_remarks(*noise, *whole_golden, comparisons))
    report.remarks.push_back(std::move(remark));
  if (scenario.horizon && noise->horizon() && *scenario.horizon >= *noise->horizon())
    report.remarks.push_back(fmt::format("the scenario's horizon, {:g} s, is not before {:g} s, when a perturbed run left the "
                                         "tolerances",
                                         *scenario.horizon, *noise->horizon()));
}

/// Why the golden's world doesn't follow its commands, or isn't what was read of it: then only its controllers can be
/// checked. Empty: it can be simulated again.
std::string why_no_world(const Trace& golden) {
  const RunFacts run = RunFacts::of(golden);
  if (run.is_of_log) return "the golden was recorded from a log: there is no physics to repeat";
  const std::optional<BranchOrigin>& origin = run.branch;
  if (origin && !origin->simulated) return "the golden is a replay: its world didn't follow its commands";
  if (origin && !origin->set.empty())
    return "the golden is a branch whose inputs were altered: nothing makes them again";
  return {};
}

/// A branch was pushed beside what its scenario says.
Result<Scenario> with_pushes_of(const std::optional<BranchOrigin>& origin, Scenario scenario) {
  if (!origin) return scenario;
  for (const std::string& text : origin->push) {
    const auto push = parse_push(text, scenario);
    if (!push) return push.errors();
    scenario.pushes.push_back(*push);
  }
  return scenario;
}

}  // namespace

Result<RunSummary> make_run(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                            const Simulation& simulation) {
  if (auto made = make_folder_of(actual); !made) return made.errors();
  return simulation.record(scenario, actual, options.run);
}

HostOptions with_controllers_of(const Scenario& scenario, const HostOptions& given) {
  HostOptions options = given;
  const auto add = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const fs::path file = fs::path(scenario.file).parent_path() / controller.library;
    std::error_code ignored;
    const bool is_beside = fs::is_regular_file(file, ignored);  // the recording doesn't know where its paths begin
    options.controllers[body.name + "/" + controller.name] = {
        is_beside ? fs::absolute(file, ignored).string() : controller.library, controller.options, controller.delay,
        controller.optional};
  };
  options.run_options = scenario.options;
  for (const ScenarioBody& body : scenario.bodies) {
    for (const ScenarioController& controller : body.controllers) {
      add(body, controller);
      for (const ScenarioController& child : controller.children) add(body, child);
    }
  }
  return options;
}

Result<ReplayReport> replay_golden(const Scenario& scenario, const Trace& golden, const HostOptions& host,
                                   std::optional<double> until) {
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = host;
  replaying.until = until;
  const auto recorded = RunFacts::of(golden).provenance;
  const bool computes_alike = recorded && other_arithmetic(*recorded, provenance(scenario, nullptr, "", "")).empty();
  if (!computes_alike) replaying.tolerances = scenario.tolerances;
  return replay(golden.file(), replaying);
}

LevelState state_of(const ReplayReport& replayed) {
  if (replayed.equal()) return LevelState::equal;
  return replayed.within() ? LevelState::within : LevelState::differs;
}

Result<Reproduction> try_reproduction(const Scenario& scenario, const Trace& run, const fs::path& file,
                                      const HostOptions& host, const Simulation& simulation) {
  ReproductionOptions trying;
  static_cast<HostOptions&>(trying) = with_controllers_of(scenario, host);
  return reproduce(scenario, run, fs::path(file).concat(".again"), trying, simulation);
}

std::string_view to_string(LevelState state) {
  switch (state) {
    case LevelState::equal: return "equal";
    case LevelState::within: return "within";
    case LevelState::differs: return "differs";
    case LevelState::skipped: return "skipped";
  }
  return "";
}

bool CheckReport::equal() const {
  for (const LevelState level : {controller, plant, closed})
    if (level != LevelState::equal && level != LevelState::skipped) return false;
  return true;
}

bool CheckReport::within() const {
  for (const LevelState level : {controller, plant, closed})
    if (level == LevelState::differs) return false;
  return true;
}

Result<CheckReport> check_scenario(const Scenario& plain, const fs::path& golden, const fs::path& actual,
                                   const CheckOptions& asked, const Simulation& simulation) {
  const auto expected = load_without_messages(golden);
  if (!expected) return expected.errors();
  if (const auto known = check_version(*expected); !known) return known.errors();
  const auto origin = RunFacts::of(*expected).branch;
  const auto pushed = with_pushes_of(origin, plain);
  if (!pushed) return pushed.errors();
  const Scenario& scenario = *pushed;
  CheckOptions options = asked;
  Check check{scenario, *expected, actual, options, simulation, {}};
  if (const std::string why = why_no_world(*expected); !why.empty()) {
    options.plant = options.closed = false;
    check.report.remarks.push_back(why + ", so the levels plant and closed are skipped");
  } else if (origin && origin->acted_until) {
    options.closed = false;
    check.report.remarks.push_back(
        fmt::format("the golden is a branch: until tick {} other controllers moved its world, so the "
                    "level closed is skipped",
                    *origin->acted_until));
  }
  if (auto done = check.find_noise(); !done) return done.errors();
  if (options.closed) {
    auto run = make_run(scenario, actual, options, simulation);
    if (!run) return run.errors();
    check.report.run = std::move(*run);
  }
  if (const auto change = changed_time_step(scenario, *expected)) {
    if (auto done = check.tell_time_step(*change); !done) return done.errors();
    return std::move(check.report);
  }
  if (options.controller)
    if (auto done = check.check_controller(); !done) return done.errors();
  if (options.plant)
    if (auto done = check.check_plant(); !done) return done.errors();
  if (options.closed) {
    if (auto done = check.check_closed(); !done) return done.errors();
  } else {
    check.blame();
  }
  check.judge_tolerances();
  if (check.report.within()) {
    std::error_code ignored;
    fs::remove(actual, ignored);
    remove_picture_differences(actual);
  }
  return std::move(check.report);
}

}  // namespace rehearse
