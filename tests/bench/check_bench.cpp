// The cost of the plant level of a check, of a proof, and of checkpoints in a recording.
#include <rehearse/check.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <filesystem>

#include "core/replay/plant_level.h"
#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

/// Work: the plant level as a check does it: the world under the recorded commands, set back at each checkpoint and
/// recorded; that trace loaded and compared. Base: the closed level: the run recorded, loaded and compared.
void plant_level_over_closed_level(benchmark::State& state) {
  const Sr1Run& sr1 = Sr1Run::instance();
  const Trace golden = must(Trace::load(sr1.trace()));
  const Simulation simulation{record, run_plant};
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);  // a writer compresses in a thread of its own
  for (auto _ : Repeated(state)) {
    const auto plant = [&] {
      const PlantLevel level = must(compare_plant(simulation, sr1.scenario(), golden, sr1.folder() / "plant.mcap", {}));
      if (!level.comparison.equal) state.SkipWithError("the plant level differs");
    };
    const auto closed = [&] {
      must(record(sr1.scenario(), sr1.folder() / "closed.mcap"));
      const Trace run = must(Trace::load(sr1.folder() / "closed.mcap"));
      if (!compare(golden, run, sr1.scenario().tolerances).equal) state.SkipWithError("the closed level differs");
    };
    state.SetIterationTime(pairs.measure(plant, closed));
  }
  pairs.report(state, static_cast<double>(sr1.ticks()), static_cast<double>(sr1.ticks()));
}
BENCHMARK(plant_level_over_closed_level)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Compares a check of a scenario with the recording of SR1. `is_expected`: the check must end so. The golden has been
/// simulated before.
template <class Expected>
void check_over_record(benchmark::State& state, const Scenario& scenario, const Expected& is_expected) {
  const Sr1Run& sr1 = Sr1Run::instance();
  const Simulation simulation{record, run_plant, describe_plant, record_from};
  CheckOptions options;
  options.certificates = sr1.folder() / "proofs";
  std::filesystem::remove_all(*options.certificates);  // the library calls this function again with more iterations
  const auto check = [&](const Scenario& checked) {
    return must(check_scenario(checked, sr1.trace(), sr1.folder() / "checked.mcap", options, simulation));
  };
  if (check(sr1.scenario()).proved) state.SkipWithError("nothing was certified yet");
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);
  for (auto _ : Repeated(state)) {
    const auto work = [&] {
      if (!is_expected(check(scenario))) state.SkipWithError("the check has a different result");
    };
    state.SetIterationTime(pairs.measure(work, [&] { must(record(sr1.scenario(), sr1.folder() / "again.mcap")); }));
  }
  pairs.report(state, static_cast<double>(sr1.ticks()), static_cast<double>(sr1.ticks()));
}

/// The world and the controllers are those of the golden.
void proved_check_over_record(benchmark::State& state) {
  check_over_record(state, Sr1Run::instance().scenario(), [](const CheckReport& report) { return report.proved; });
}
BENCHMARK(proved_check_over_record)->UseManualTime()->Unit(benchmark::kMillisecond);

/// The controller commands differently from the middle of the last second on.
void late_difference_over_record(benchmark::State& state) {
  Scenario scenario = Sr1Run::instance().scenario();
  for (ScenarioBody& body : scenario.bodies)
    for (ScenarioController& controller : body.controllers) controller.library = LATE_CONTROLLER;
  check_over_record(state, scenario, [](const CheckReport& report) {
    return report.closed == LevelState::differs && report.simulated_from == 9400;
  });
}
BENCHMARK(late_difference_over_record)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: a whole recording with checkpoints, some of them tried out. Base: the same without. `size_ratio`: of the
/// files.
void checkpoints_over_none(benchmark::State& state) {
  const Sr1Run& sr1 = Sr1Run::instance();
  RecordOptions without;
  without.checkpoint_period = 0.0;
  const std::filesystem::path with_file = sr1.folder() / "with.mcap", without_file = sr1.folder() / "without.mcap";
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { must(record(sr1.scenario(), with_file)); },
                                         [&] { must(record(sr1.scenario(), without_file, without)); }));
  pairs.report(state, static_cast<double>(sr1.ticks()), static_cast<double>(sr1.ticks()));
  state.counters["size_ratio"] = static_cast<double>(std::filesystem::file_size(with_file)) /
                                 static_cast<double>(std::filesystem::file_size(without_file));
}
BENCHMARK(checkpoints_over_none)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
