// Runs a scenario of the fixtures in a process of its own:
//   probe SCENARIO SECONDS TRACE                        records it
//   probe SCENARIO SOLVER TRACE RECORDING TICK          goes on from a checkpoint of a recording, under its commands
#include <rehearse/pin.h>
#include <rehearse/plant_run.h>
#include <rehearse/session.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using namespace rehearse;

int fail(const Diagnostics& errors) { return std::fputs(to_string(errors).c_str(), stderr), 1; }

int record_scenario(Scenario& scenario, char** argv) {
  scenario.duration = std::atof(argv[2]);
  const auto summary = record(scenario, argv[3]);
  if (!summary) return fail(summary.errors());
  return summary->failure ? 1 : 0;
}

int go_on(Scenario& scenario, char** argv) {
  using Method = SolverSettings::Method;
  scenario.solver.method = std::string(argv[2]) == "quick" ? Method::quick : Method::exact;
  const auto recording = Trace::load(argv[4]);
  if (!recording) return fail(recording.errors());
  PlantOptions options;
  options.from = std::atoll(argv[5]);
  options.resync = false;
  const auto summary = run_plant(scenario, *recording, argv[3], options);
  if (!summary) return fail(summary.errors());
  return summary->failure || summary->restored != 1 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  pin_process(argv);
  if (argc != 4 && argc != 6) return std::fputs("usage: probe SCENARIO SECONDS TRACE, or see the source\n", stderr), 2;
  auto scenario = Scenario::load(argv[1]);
  if (!scenario) return fail(scenario.errors());
  return argc == 4 ? record_scenario(*scenario, argv) : go_on(*scenario, argv);
}
