#include "check_run.h"

#include <algorithm>
#include <array>

#include "core/host/hosted_language.h"
#include "core/recording/provenance.h"
#include "core/replay/plant_level.h"
#include "core/trace/run_facts.h"
#include "own_run.h"

namespace rehearse {

namespace fs = std::filesystem;

Result<ResumedRun> make_run(const Scenario& scenario, const Trace& golden, const ReplayReport* replayed,
                            const fs::path& actual, const RecordOptions& options, const Simulation& simulation) {
  const bool begins_alike =
      replayed && replayed->first_other_hash && !replayed->failure && !replayed->controller_refused;
  if (!begins_alike || !simulation.record_from) {
    auto whole = REHEARSE_TRY(make_run(scenario, actual, options, simulation));
    return ResumedRun{std::move(whole), 0};
  }
  REHEARSE_TRY(make_folder_of(actual));
  return own_run([&]() -> Result<ResumedRun> {
    return simulation.record_from(scenario, golden, *replayed->first_other_hash, actual, options);
  });
}

Result<RunSummary> make_run(const Scenario& scenario, const fs::path& actual, const RecordOptions& options,
                            const Simulation& simulation) {
  REHEARSE_TRY(make_folder_of(actual));
  return own_run([&]() -> Result<RunSummary> { return simulation.record(scenario, actual, options); });
}

HostOptions with_controllers_of(const Scenario& scenario, const HostOptions& given) {
  HostOptions options = given;
  const auto add = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const fs::path file = fs::path(scenario.file).parent_path() / controller.library;
    std::error_code ignored;
    const bool is_beside = is_controller_file(file);  // a recording has no folder for relative paths
    options.controllers[body.name + "/" + controller.name] = {
        is_beside ? fs::absolute(file, ignored).string() : controller.library, controller.options, controller.delay,
        controller.optional, controller.threads};
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

ReplayOptions as_here(const HostOptions& host) {
  ReplayOptions options;
  static_cast<HostOptions&>(options) = host;
  options.provides_files = false;
  return options;
}

bool computes_alike(const Scenario& scenario, const Trace& golden) {
  const auto recorded = RunFacts::of(golden).provenance;
  return recorded && other_arithmetic(*recorded, provenance(scenario, nullptr, "", "")).empty();
}

namespace {

LevelState state_of(const ReplayReport& replayed, bool computes_alike) {
  if (replayed.equal()) return LevelState::equal;
  const bool may_differ = !computes_alike || replayed.commands_hold;
  return may_differ && replayed.within() ? LevelState::within : LevelState::differs;
}

}  // namespace

Result<ControllerLevel> replay_golden(const Scenario& scenario, const Trace& golden, const HostOptions& host) {
  ReplayOptions replaying = as_here(host);
  replaying.tolerances = scenario.tolerances;
  auto replayed = REHEARSE_TRY(own_replay(golden.file(), replaying));
  const LevelState state = state_of(replayed, computes_alike(scenario, golden));
  return ControllerLevel{std::move(replayed), state};
}

bool any_level_differs(const CheckReport& report) {
  return std::ranges::count(std::array{report.controller, report.plant, report.closed}, LevelState::differs) > 0;
}

Result<Reproduction> try_reproduction(const Scenario& scenario, const Trace& run, const fs::path& file,
                                      const HostOptions& host, const Simulation& simulation) {
  ReproductionOptions trying;
  static_cast<HostOptions&>(trying) = with_controllers_of(scenario, host);
  return reproduce(scenario, run, fs::path(file).concat(".again"), trying, simulation);
}

}  // namespace rehearse
