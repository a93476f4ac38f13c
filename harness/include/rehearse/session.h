// Session: one closed-loop run of a scenario (sense, control, actuate, step), which is recorded completely.
//
// A plant run (run_plant) is the run of a world under the commands of a recording, without its controllers: the plant
// level of a check. At each checkpoint of the recording the world is set back to the recorded state. So a difference
// never grows for longer than from one checkpoint to the next. It shows the change of the simulation itself, not its
// consequences. The state at a checkpoint is recorded before the recorded state is restored.
//
// Needs the simulation (ODE, and OSMesa if a camera runs). For recorded inputs without simulation: replay.h.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>
#include <rehearse/replay.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// Runs the scenario and writes the trace. Fails, and writes nothing, if the run can't begin: a library doesn't load, a
/// body can't be simulated, a file can't be created. A controller that fails later ends the run; the trace stays valid.
Result<RunSummary> record(const Scenario& scenario, const std::filesystem::path& trace,
                          const RecordOptions& options = {});

struct ClosedLoop;

/// One run, stepped tick by tick.
class Session {
 public:
  /// Loads the controllers and opens the trace. Fails, and writes nothing, as record() does.
  static Result<std::unique_ptr<Session>> create(const Scenario& scenario, const std::filesystem::path& trace,
                                                 const RecordOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Makes one tick. Returns false if the run is over, by its duration or by a failure.
  Result<bool> step();
  /// The tick that step() makes next.
  std::int64_t tick() const;
  /// Calls stop() of the controllers, records the last state and closes the trace.
  Result<RunSummary> finish();

 private:
  explicit Session(std::unique_ptr<ClosedLoop> loop);
  std::unique_ptr<ClosedLoop> loop_;
};

/// Runs the scenario's world under the recorded commands and writes the results into a trace: state, sensors, frames
/// and the hash of the state. It runs from the start without checkpoints, and reports this, in three cases: the
/// recording has no checkpoints, it states that they aren't exact, or this version can't restore their format. Fails if
/// the run can't begin, or if the scenario doesn't fit the recording: it lacks something that the recording commands,
/// has a different time step, or has parts without state in the checkpoints.
Result<PlantSummary> run_plant(const Scenario& scenario, const Trace& recording, const std::filesystem::path& trace,
                               const PlantOptions& options = {});

/// All facts on which the bits of this scenario's world depend in this process, a hash or an identifier under each
/// name: the program and the libraries of the process, its pinned arithmetic, the processor's maker, the scenario
/// without its controllers' libraries and the parts that judge runs, models, meshes. The scenario must be as
/// Scenario::load made it. Fails if the bits may depend on something else: the process isn't pinned, the
/// file of a library was replaced after the process had loaded it.
Result<mcap::StringMap> describe_plant(const Scenario& scenario);

/// Runs the scenario and writes the trace, as record() does, but simulates only from the golden's last suitable
/// checkpoint before the tick `moment` on. The golden must be a run of this world, and its controllers must command
/// the same as the scenario's controllers in all ticks before `moment`. If the golden's part can't be copied (no
/// checkpoint, events of the world, a different state than recorded), everything is simulated.
Result<ResumedRun> record_from(const Scenario& scenario, const Trace& golden, std::int64_t moment,
                               const std::filesystem::path& trace, const RecordOptions& options = {});

// Branch: a recording that begins as a copy of a source recording and differs from it from a given moment on.
//
// Until the moment it contains the source's states, sensors and frames without change. The recorded controllers, or
// others, get the source's inputs from tick 0 on, so that their memory is right; their outputs are recorded. At the
// moment the world has the source's state, and the loop is closed. A branch is a whole recording: it can be replayed,
// compared and branched from. Its metadata record `rehearse.branch` states its source. Without any change it equals the
// source, bit for bit. Needs the simulation, like session.h.

/// "TRACE@3.2s" or "TRACE@tick:640".
struct BranchPoint {
  std::filesystem::path trace;       // the source
  std::optional<double> time;        // [s]; none: `tick` is set
  std::optional<std::int64_t> tick;  // none: `time` is set

  /// Fails with a caret under the part that can't be read.
  static Result<BranchPoint> parse(const std::string& text);
};

/// The changes from the source.
struct BranchOptions : HostOptions {
  /// The recorded scenario file; it names the models' meshes, which no recording contains. The file, its models and
  /// meshes must be unchanged. Empty: the recording is sufficient, if there are no meshes.
  std::filesystem::path scenario;
  /// The end as time of the run [s]; without it and `duration` the source's end.
  std::optional<double> until;
  /// The end as duration after the moment [s].
  std::optional<double> duration;
  /// Inputs that are altered before controllers see them, as ReplayOptions::set; inputs before the moment are altered,
  /// too.
  std::vector<std::string> set;
  /// Pushes in addition to the scenario's pushes: "BODY/LINK force=X,Y,Z torque=X,Y,Z at=X,Y,Z @SPAN". No push may
  /// begin before the moment.
  std::vector<std::string> push;
  /// Called about every hundredth of the simulated span with the number of simulated ticks and the number of all ticks
  /// of the span; null: never called.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// The result of record_branch().
struct BranchSummary {
  RunSummary run;         // the whole recording
  std::int64_t tick = 0;  // tick of the moment
  double time = 0.0;      // time of this tick [s]
  std::string world;      // a sentence: how the state of the world was restored
  /// Differences of the controllers' outputs before the moment from the source's.
  ReplayReport before;
  /// The number of the source's chunks that were copied as they are stored, because the controllers repeat what they
  /// did; 0: messages were written anew.
  std::int64_t copied_chunks = 0;
};

/// Writes the branch into `trace`. Fails, and writes nothing, if the source is no recording of a simulation, doesn't
/// contain that moment, or lacks inputs of the controllers; if an option is invalid; or if a controller fails before
/// the moment.
Result<BranchSummary> record_branch(const BranchPoint& from, const std::filesystem::path& trace,
                                    const BranchOptions& options = {});

}  // namespace rehearse
