#include "perturbed_run.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/hashing.h"
#include "check_run.h"
#include "core/compare/place_json.h"
#include "core/golden/golden_files.h"
#include "core/guard/interruption.h"
#include "own_run.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* report_file = "report.json";

/// The hash of results of the C library's functions: two variants of them differ in about one of 10^4 results.
std::uint64_t hash_of_mathematics() {
  constexpr int arguments = 50000;
  std::uint64_t hash = 0;
  for (int i = 1; i <= arguments; ++i) {
    volatile double x = 7.0 * i / arguments;  // so that the compiler computes none of it
    const double values[] = {std::sin(x), std::cos(x), std::atan(x), std::exp(x), std::log(x), std::pow(x, 1.7)};
    hash = hash_bytes(values, sizeof values, hash);
  }
  return hash;
}

/// Feeds the controllers with the recorded inputs, and reports the largest differences of their commands from the
/// recorded ones.
Result<void> replay_into(const PerturbedRun& run, const Scenario& scenario, Json& report) {
  std::map<std::pair<std::string, std::string>, double> largest;
  ReplayOptions options = as_here(run.host);
  options.tolerances = scenario.tolerances;
  options.on_difference = [&](const Divergence& found) {
    double& so_far = largest[{found.channel, found.unit}];
    so_far = std::max(so_far, finite(found.difference));
  };
  const auto replayed = REHEARSE_TRY(replay(run.recording, options));
  if (replayed.failure) return *replayed.failure;
  for (const auto& [place, difference] : largest)
    report["commands"].push_back({{"channel", place.first}, {"unit", place.second}, {"difference", difference}});
  report["beyond"] = json_of_place(replayed.beyond);
  return {};
}

std::vector<std::string> command_line(const fs::path& program, const PerturbedRun& run) {
  std::vector<std::string> words{program.string(), "golden",
                                 "noise",          run.scenario.string(),
                                 "--perturbed",    run.folder.string(),
                                 "--recording",    run.recording.string(),
                                 "--duration",     fmt::format("{}", run.duration)};
  for (const auto& [level, wanted] :
       {std::pair{"controller", run.controller}, {"plant", run.plant}, {"closed", run.closed}})
    if (wanted) words.insert(words.end(), {"--level", level});
  for (const auto& [name, library] : run.host.libraries)
    words.insert(words.end(), {"--controller", fmt::format("{}={}", name, library)});
  return words;
}

Result<PerturbedOutcome> outcome_in(const fs::path& file) {
  const auto text = REHEARSE_TRY(read_text(file));
  const Json report = Json::parse(text, nullptr, false);
  PerturbedOutcome outcome;
  try {
    outcome.same_mathematics = report.at("mathematics").get<std::uint64_t>() == hash_of_mathematics();
    for (const Json& command : report.at("commands"))
      outcome.commands[{command.at("channel"), command.at("unit")}] = command.at("difference");
    outcome.beyond = place_of_json(report.at("beyond"));
  } catch (const Json::exception& wrong) {
    return error(fmt::format("{}: the perturbed run's report can't be read: {}", file.string(), wrong.what()));
  }
  return outcome;
}

}  // namespace

Result<void> make_perturbed_run(const PerturbedRun& run, const Simulation& simulation) {
  auto scenario = REHEARSE_TRY(Scenario::load(run.scenario));
  scenario.duration = run.duration;
  Json report{{"mathematics", hash_of_mathematics()}, {"commands", Json::array()}, {"beyond", nullptr}};
  if (run.plant) {
    const auto recording = REHEARSE_TRY(Trace::load(run.recording));
    const auto plant =
        REHEARSE_TRY(own_plant(simulation.run_plant)(scenario, recording, run.folder / "plant.mcap", {}));
    if (plant.failure) return *plant.failure;
  }
  if (run.closed) {
    RecordOptions options;
    static_cast<HostOptions&>(options) = run.host;
    const auto closed = REHEARSE_TRY(own_run(
        [&]() -> Result<RunSummary> { return simulation.record(scenario, run.folder / "closed.mcap", options); }));
    if (closed.failure) return *closed.failure;
  }
  if (run.controller)  // last: this process itself runs the controllers
    REHEARSE_TRY(replay_into(run, scenario, report));
  std::ofstream stream(run.folder / report_file);
  stream << report.dump(1);
  stream.close();
  if (!stream) return error(fmt::format("can't write {}", (run.folder / report_file).string()));
  return {};
}

Result<PerturbedOutcome> run_perturbed_process(const fs::path& program, const PerturbedRun& run,
                                               const EnvironmentChanges& changes) {
  EnvironmentChanges unpinned = changes;
  unpinned.insert_or_assign("REHEARSE_PIN", std::string("off"));
  const auto status = REHEARSE_TRY(run_to_end({.words = command_line(program, run),
                                               .environment = environment_with(unpinned),
                                               .errors = ChildProcess::Errors::shown},
                                              [] { return interruption() != 0; }));
  if (status != 0) return error(fmt::format("the perturbed run failed with status {}", status));
  return outcome_in(run.folder / report_file);
}

}  // namespace rehearse
