// Session: one closed-loop run of a scenario: sense, control, actuate, step, and all of it recorded.
//
// A plant run (run_plant) is the run of a world under the commands of a recording, without its controllers: the plant
// level of a check. At each checkpoint of the recording the world is set back to the recorded state, so that a
// difference never grows for longer than from one checkpoint to the next: what is left is what the simulation does
// otherwise, not what became of it. The state at a checkpoint itself is recorded before it is restored.
//
// Needs the simulation (ODE, and OSMesa if a camera runs). For recorded inputs without simulation: replay.h.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>
#include <rehearse/simulation.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace rehearse {

/// Runs the scenario and writes the trace. Fails, with nothing written, if it can't begin: a library that doesn't load,
/// a body that can't be simulated, a file that can't be created. A controller that fails later ends the run, not the
/// trace.
Result<RunSummary> record(const Scenario& scenario, const std::filesystem::path& trace,
                          const RecordOptions& options = {});

/// One run, a tick at a time.
class Session {
 public:
  static Result<std::unique_ptr<Session>> create(const Scenario& scenario, const std::filesystem::path& trace,
                                                 const RecordOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// One tick. False: the run is over, by its duration or by a failure.
  Result<bool> step();
  std::int64_t tick() const;
  /// stop() of the controllers, the last state, the trace's end.
  Result<RunSummary> finish();

 private:
  struct Impl;
  explicit Session(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Runs the scenario's world under the recorded commands and writes what it did into a trace: state, sensors, frames
/// and the hash of the state. If the recording has no checkpoints, or says that they aren't exact, or they are of a
/// kind that this version can't restore, it runs from the start without them and says so. Fails if the recording
/// commands something that the scenario hasn't, if the scenario has another time step or parts that the checkpoints
/// have no state of, or if the run can't begin.
Result<PlantSummary> run_plant(const Scenario& scenario, const Trace& recording, const std::filesystem::path& trace,
                               const PlantOptions& options = {});

}  // namespace rehearse
