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
#include <rehearse/replay.h>
#include <rehearse/scenario.h>
#include <rehearse/simulation.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

// Branch: a recording that begins as another one and goes its own way from a moment on.
//
// Until the moment its states, sensors and frames are the source's, as they are; the controllers, the recorded ones or
// others, are fed with the source's inputs from tick 0 on, so that their memory is right, and what they do is recorded.
// At the moment the world is the source's, and the loop is closed. A branch is a whole recording: it is replayed,
// compared and branched from like any other. Its metadata record `rehearse.branch` says where it came from. Without any
// change it is the source, bit for bit. Needs the simulation, like session.h.

/// "TRACE@3.2s" or "TRACE@tick:640".
struct BranchPoint {
  std::filesystem::path trace;
  std::optional<double> time;  // [s]; else:
  std::optional<std::int64_t> tick;

  /// Fails with a caret under what can't be read.
  static Result<BranchPoint> parse(const std::string& text);
};

struct BranchOptions : HostOptions {
  /// The scenario file that was recorded: the models' meshes, which no recording holds, are those that it names. It has
  /// to be what it was, and so have its models and meshes. Empty: the recording is enough, if there are no meshes.
  std::filesystem::path scenario;
  /// The end, as time of the run [s], or so long after the moment [s]; none: the source's.
  std::optional<double> until, duration;
  /// Inputs that are altered before controllers see them, as ReplayOptions::set; those before the moment, too.
  std::vector<std::string> set;
  /// "BODY/LINK force=X,Y,Z torque=X,Y,Z at=X,Y,Z @SPAN": beside those of the scenario. None may begin before the
  /// moment.
  std::vector<std::string> push;
  /// Called about every hundredth of what is simulated, with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct BranchSummary {
  RunSummary run;
  std::int64_t tick = 0;  // where it branches
  double time = 0.0;      // of it [s]
  std::string world;      // how the world came to be there: a sentence
  /// What the controllers did before the moment that they did not when the source was recorded.
  ReplayReport before;
};

/// Writes the branch into `trace`. Fails, with nothing written, if the source is no recording of a simulation, hasn't
/// that moment, or lacks what the controllers read; if something of the options makes no sense; or if a controller
/// fails before the moment.
Result<BranchSummary> record_branch(const BranchPoint& from, const std::filesystem::path& trace,
                                    const BranchOptions& options = {});

}  // namespace rehearse
