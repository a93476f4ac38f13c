#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/picture_difference.h>
#include <rehearse/reproduction.h>

#include <nlohmann/json.hpp>

#include <rehearse/noise_floor.h>

#include "blame.h"
#include "compare/report_json.h"
#include "plant_level.h"
#include "recording/provenance.h"
#include "replay/branch_origin.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

LevelState state_of(const Comparison& comparison) {
  if (comparison.equal) return LevelState::equal;
  return comparison.within ? LevelState::within : LevelState::differs;
}

/// Libraries and options of the scenario as it is now. The golden's own scenario knows names of libraries only, not where
/// paths begin, and other options are a change of the controller.
HostOptions host_options(const Scenario& scenario, const HostOptions& given) {
  HostOptions options = given;
  const auto add = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const fs::path file = fs::path(scenario.file).parent_path() / controller.library;
    std::error_code ignored;
    if (given.libraries.count(controller.name) == 0 && fs::is_regular_file(file, ignored))
      options.libraries.emplace(body.name + "/" + controller.name, fs::absolute(file, ignored).string());
    options.controller_options.emplace(body.name + "/" + controller.name, controller.options);
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

/// One check under way.
struct Check {
  const Scenario& scenario;
  const Trace& golden;
  fs::path actual;
  const CheckOptions& options;
  const Simulation& simulation;
  CheckReport report;
  std::optional<NoiseFloor> noise = std::nullopt;  // that was measured of the golden

  fs::path plant_trace() const { return actual.parent_path() / "plant" / actual.filename(); }
  Result<void> check_controller();
  Result<void> check_plant();
  Result<void> check_closed();
  void blame();
  Result<void> certify(const Trace& fresh);
  void judge_by_expectations(const Trace& fresh);
  void find_noise();
  void judge_tolerances();
  void tell_files(const Trace& fresh, const Comparison& comparison, const fs::path& file, const char* what);
};

/// The run that closed compares. First of all, because it knows best why a run can't begin.
Result<RunSummary> make_run(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                            const Simulation& simulation) {
  if (auto made = make_folder_of(actual); !made) return made.errors();
  return simulation.record(scenario, actual, options.run);
}

/// Whether a run repeats itself; what the world does meanwhile is written beside it.
Result<Reproduction> try_reproduction(const Scenario& scenario, const Trace& run, const fs::path& file,
                                      const HostOptions& host, const Simulation& simulation) {
  ReproductionOptions trying;
  static_cast<HostOptions&>(trying) = host_options(scenario, host);
  return reproduce(scenario, run, fs::path(file).concat(".again"), trying, simulation);
}

/// Whether the same program gives the same bits here as where the golden was recorded.
bool computes_alike(const Scenario& scenario, const Trace& golden) {
  const mcap::StringMap* recorded = golden.find_metadata("rehearse");
  return recorded && other_arithmetic(*recorded, provenance(scenario, nullptr, "", "")).empty();
}

/// The bits have to be the same, unless the arithmetic isn't: a controller that calls sin() then commands other last
/// bits, and is judged within tolerance.
Result<void> Check::check_controller() {
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = host_options(scenario, options.run);
  if (!computes_alike(scenario, golden)) replaying.tolerances = scenario.tolerances;
  auto replayed = replay(golden.file(), replaying);
  if (!replayed && !options.closed) return replayed.errors();
  report.controller = LevelState::differs;
  if (!replayed) {
    report.controller_problem = replayed.errors()[0].message;
    return {};
  }
  if (replayed->within()) report.controller = replayed->equal() ? LevelState::equal : LevelState::within;
  report.replay = *std::move(replayed);
  return {};
}

Result<void> Check::check_plant() {
  const fs::path file = plant_trace();
  PlantOptions running;
  running.progress = options.run.progress;
  auto level = compare_plant(simulation, scenario, golden, file, running,
                             noise ? noise_of_series(*noise, golden) : NoiseOfSeries());
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
  const auto fresh = Trace::load(actual);
  if (!fresh) return fresh.errors();
  const std::optional<double> measured = estimated_horizon(golden);
  report.horizon = horizon_of(scenario, options.estimated_horizon ? options.estimated_horizon : measured);
  CompareOptions what;
  what.until = report.horizon;
  report.comparison = compare(golden, *fresh, scenario.tolerances, what);
  report.closed = state_of(*report.comparison);
  report.expectations = judge_expectations(scenario.expectations, *fresh);
  if (report.closed == LevelState::differs || first_violation(report.expectations))
    tell_files(*fresh, *report.comparison, actual, "this run");
  blame();
  if (auto done = certify(*fresh); !done) return done;
  if (report.not_reproduced) tell_files(*fresh, *report.comparison, actual, "this run");
  judge_by_expectations(*fresh);
  return {};
}

/// Tolerances are for what changed. Where nothing did, or where a run doesn't repeat itself, other bits are chance, and
/// a golden that is met by chance certifies nothing.
Result<void> Check::certify(const Trace& fresh) {
  if (report.closed != LevelState::within) return {};
  auto found = try_reproduction(scenario, fresh, actual, options.run, simulation);
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
  report.verdict = is_alone ? judged + "; " + report.verdict : report.verdict + "; " + judged;
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
      {scenario, golden, simulation, host_options(scenario, options.run), plant_trace().concat(".again")}, report);
  report.verdict = found.sentence;
  report.first = found.place;
}

/// A golden without a measurement is fine.
void Check::find_noise() {
  const fs::path file = noise_file_of(golden.file());
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return;
  auto found = load_noise_floor(file);
  if (found)
    noise = *std::move(found);
  else
    report.remarks.push_back("the measured noise can't be read: " + to_string(found.errors()[0]));
}

/// What the noise says of the tolerances.
void Check::judge_tolerances() {
  if (!noise) return;
  std::vector<const Comparison*> comparisons;
  if (report.plant_comparison) comparisons.push_back(&*report.plant_comparison);
  if (report.comparison) comparisons.push_back(&*report.comparison);
  for (std::string& remark : noise_remarks(*noise, golden, comparisons)) report.remarks.push_back(std::move(remark));
  if (scenario.horizon && noise->horizon() && *scenario.horizon >= *noise->horizon())
    report.remarks.push_back(fmt::format("the scenario's horizon, {:g} s, is not before {:g} s, when a perturbed run left the "
                                         "tolerances",
                                         *scenario.horizon, *noise->horizon()));
}

/// Why the golden's world doesn't follow its commands, or isn't what was read of it: then only its controllers can be
/// checked. Empty: it can be simulated again.
std::string why_no_world(const Trace& golden) {
  const mcap::StringMap* facts = golden.find_metadata("rehearse");
  if (facts && facts->count("source") && facts->at("source") == "log")
    return "the golden was recorded from a log: there is no physics to repeat";
  const auto origin = BranchOrigin::of(golden.find_metadata(branch_record));
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
  const auto expected = Trace::load(golden);
  if (!expected) return expected.errors();
  if (const auto known = check_version(*expected); !known) return known.errors();
  const auto origin = BranchOrigin::of(expected->find_metadata(branch_record));
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
  check.find_noise();
  if (options.closed) {
    auto run = make_run(scenario, actual, options, simulation);
    if (!run) return run.errors();
    check.report.run = std::move(*run);
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

namespace {

/// A run that no golden speaks of: what the scenario expects of it is all there is to judge.
Result<CheckReport> check_by_expectations(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                                          const Simulation& simulation) {
  CheckReport report;
  auto run = make_run(scenario, actual, options, simulation);
  if (!run) return run.errors();
  report.run = std::move(*run);
  if (scenario.expectations.empty()) return report;
  const auto fresh = Trace::load(actual);
  if (!fresh) return fresh.errors();
  report.expectations = judge_expectations(scenario.expectations, *fresh);
  report.verdict = verdict(report.expectations);
  report.closed = LevelState::within;
  if (const ExpectationResult* violation = first_violation(report.expectations)) {
    report.closed = LevelState::differs;
    report.first = divergence_of(*violation, *fresh);
    report.message = fmt::format("this run: {}{}", actual.string(), violation_lines(report.expectations));
  }
  return report;
}

/// Whether a run that is to become a golden repeats itself. If not, the report says so.
Result<bool> certify_candidate(const Scenario& scenario, const fs::path& actual, const HostOptions& host,
                               const Simulation& simulation, CheckReport& report) {
  const auto candidate = Trace::load(actual);
  if (!candidate) return candidate.errors();
  const auto found = try_reproduction(scenario, *candidate, actual, host, simulation);
  if (!found) return found.errors();
  if (found->reproduced()) return true;
  report.closed = LevelState::differs;
  report.not_reproduced = true;
  report.verdict = fmt::format("this run becomes no golden: {}", found->verdict);
  report.first = found->first;
  report.message = fmt::format("this run: {}", actual.string());
  return false;
}

/// There is no golden yet: the run becomes it, or waits to be.
Result<CheckReport> first_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation) {
  const fs::path actual = store.pending_file(scenario.golden);
  auto report = check_by_expectations(scenario, actual, options, simulation);
  if (!report) return report;
  const bool violated = !report->within();
  const std::string judged = report->verdict.empty() ? "" : "; " + report->verdict;
  if (mode == GoldenMode::check || violated) {
    report->closed = LevelState::differs;
    report->verdict = fmt::format("there is no golden {}{}", store.trace_file(scenario.golden).string(), judged);
    if (!violated)
      report->message =
          fmt::format("this run: {}\nif it is right: rehearse golden accept {}", actual.string(), scenario.golden);
    return report;
  }
  auto certified = certify_candidate(scenario, actual, options.run, simulation, *report);
  if (!certified) return certified.errors();
  if (!*certified) return report;
  if (auto accepted = store.accept_pending(scenario.golden); !accepted) return accepted.errors();
  report->closed = LevelState::skipped;  // there was nothing to compare with
  report->golden_written = true;
  report->verdict = fmt::format("wrote the new golden {}{}", store.trace_file(scenario.golden).string(), judged);
  return report;
}

/// No golden is named, but something is expected.
Result<CheckReport> check_without_golden(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                                         const Simulation& simulation) {
  auto report = check_by_expectations(scenario, actual, options, simulation);
  std::error_code ignored;
  if (report && report->within()) fs::remove(actual, ignored);
  return report;
}

/// What becomes of a run that waits.
Result<void> settle_pending(const Scenario& scenario, GoldenStore& store, GoldenMode mode, const HostOptions& host,
                            const Simulation& simulation, CheckReport& report) {
  const std::string& name = scenario.golden;
  if (first_violation(report.expectations)) {
    report.message += fmt::format("\nif it is right, {} expects what is wrong", scenario.file);
  } else if (mode == GoldenMode::accept) {
    auto certified = certify_candidate(scenario, store.pending_file(name), host, simulation, report);
    if (!certified) return certified.errors();
    if (!*certified) return {};
    if (auto accepted = store.accept_pending(name); !accepted) return accepted.errors();
    report.golden_written = true;
    report.message = fmt::format("replaced {}", store.trace_file(name).string());
  } else {
    report.message +=
        fmt::format("\nif it is right: rehearse golden accept {0}\nlook at it: rehearse golden review {0}", name);
  }
  return {};
}

}  // namespace

Result<CheckReport> check_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation) {
  const std::string& name = scenario.golden;
  if (name.empty() && options.closed && !scenario.expectations.empty())
    return check_without_golden(scenario, store.pending_file(scenario.name), options, simulation);
  if (name.empty()) {
    Diagnostic finding = error("the scenario names no golden to compare with, and expects nothing of a run",
                               "golden: Suite.Test, or expect: what has to be true");
    finding.file = scenario.file;
    return finding;
  }
  if (!store.has(name)) return first_golden(scenario, store, mode, options, simulation);
  const fs::path actual = store.pending_file(name);
  auto report = check_scenario(scenario, store.trace_file(name), actual, options, simulation);
  if (!report) return report;
  if (options.closed && !report->within()) {
    if (auto done = settle_pending(scenario, store, mode, options.run, simulation, *report); !done) return done.errors();
  } else if (const auto digest = store.check_digest(name); !digest) {
    return digest.errors();
  }
  return report;
}

namespace {

nlohmann::ordered_json or_null(const std::optional<Comparison>& comparison) {
  return comparison ? json_of(*comparison) : nlohmann::ordered_json();
}

nlohmann::ordered_json json_of(const ExpectationResult& result) {
  nlohmann::ordered_json object{
      {"text", result.text}, {"line", result.expectation.place.line}, {"holds", result.holds}, {"first", nullptr}};
  if (result.first)
    object["first"] = {{"series", result.series},
                       {"tick", result.first->tick},
                       {"time", result.first->time},
                       {"value", result.first->value ? number_json(*result.first->value) : nlohmann::ordered_json()}};
  return object;
}

}  // namespace

std::string to_json(const CheckReport& report) {
  nlohmann::ordered_json object{{"verdict", report.verdict},
                                {"equal", report.equal()},
                                {"within", report.within()},
                                {"not_reproduced", report.not_reproduced},
                                {"levels",
                                 {{"controller", to_string(report.controller)},
                                  {"plant", to_string(report.plant)},
                                  {"closed", to_string(report.closed)}}},
                                {"first", json_of(report.first)},
                                {"comparisons",
                                 {{"plant", or_null(report.plant_comparison)}, {"closed", or_null(report.comparison)}}},
                                {"horizon", nullptr},
                                {"expectations", nlohmann::ordered_json::array()},
                                {"remarks", report.remarks}};
  if (report.horizon) object["horizon"] = *report.horizon;
  for (const ExpectationResult& result : report.expectations) object["expectations"].push_back(json_of(result));
  return text_of(object);
}

}  // namespace rehearse
