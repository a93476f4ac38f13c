// The options of runs: HostOptions for the controllers of any run, RecordOptions and PlantOptions for runs with
// physics; and the results of runs with physics.
//
// session.h declares the functions that make runs with physics. They need ODE, and OSMesa for cameras. A library that
// neither simulates nor renders (a check, a partial acceptance) gets these functions from its caller, as a Simulation.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

class ControllerWatch;

/// A controller from a different scenario.
struct GivenController {
  std::string library;    // a name or an absolute path
  std::string options;    // its own option string
  bool delay = true;      // commands act one tick late
  bool optional = false;  // the run continues without it if it refuses to take part
  ThreadRules threads;    // of its own threads
};

/// The controllers of a run, and how they are called; independent of the scenario.
struct HostOptions {
  /// Library (a name or a path) to load instead of any other, by controller: NAME or BODY/NAME.
  std::map<std::string, std::string> libraries;
  /// Controllers that replace the scenario's controllers, by BODY/NAME.
  std::map<std::string, GivenController> controllers;
  /// The options of the whole run instead of the scenario's; none: the scenario's.
  std::optional<std::string> run_options;
  /// Limit of the wall time of a call into a controller [s]; a longer call counts as hung.
  double call_limit = 10.0;
  /// Limit of the memory of the process that calls the controllers [MB]; 0: four fifths of the memory that is
  /// available when the process starts. Without a supervisor it has no effect.
  double memory_limit = 0.0;
  /// Count the costs of control() and record them; also true if the scenario says so.
  bool counts_costs = false;
  /// Libraries and the contents of their static objects stay loaded after the run.
  bool keep_libraries = false;
  /// Called with each line that a controller writes to os(), after the call in which it does; null: never called.
  std::function<void(const std::string& controller, const std::string& line)> on_message;
  /// Is notified of each call; null: nothing is notified. Must outlive the run.
  ControllerWatch* watch = nullptr;
};

/// The options of a run in simulation.
struct RecordOptions : HostOptions {
  /// Simulated time from one checkpoint to the next [s]; at least a tick. 0: no checkpoints are recorded, and the plant
  /// level of a check runs from the start.
  double checkpoint_period = 0.1;
  /// Moves each body by a last bit before the first tick, to measure how this perturbation grows. See World::nudge().
  std::optional<std::uint32_t> nudge;
  /// Called about every hundredth of the run with the number of simulated ticks and the number of all ticks; null:
  /// never called.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// The end of a run.
enum class RunEnding {
  complete,
  refused,   // a controller returned false from configure, initialize or start
  threw,     // an exception left a controller
  exited,    // a controller tried to end the process
  crashed,   // a signal in a controller: segmentation fault, abort
  hung,      // a call into a controller exceeded its limit
  exploded,  // a position or velocity is no longer finite
  interrupted,
};

/// The costs of a controller's calls of control() after tick 0, as sums (messages.h: ControlCost).
struct ControlCosts {
  struct Count {
    std::string_view name;         // "allocations", as the field of msg::ControlCost
    std::uint64_t total = 0;       // of all ticks but tick 0
    std::int64_t ticks = 0;        // ticks that have at least one
    std::int64_t first_tick = -1;  // -1: none has
  };
  std::vector<Count> counts;
  /// Accesses for which the kernel had to map a page; they depend on the machine, and no recording contains them.
  Count page_faults = {"page_faults"};

  /// Adds the costs of a tick; ticks ascend.
  void add(std::int64_t tick, const msg::ControlCost& cost, std::uint64_t page_faults);
  /// True if no call after tick 0 allocates, releases, locks, calls the system or throws.
  bool is_realtime_safe() const;
};

/// The wall times of a controller's calls of control(), by the clock of the machine: they differ from run to run, and
/// no recording contains them. Each is at most 1.6 % too long, the longest is exact.
struct ControlTimes {
  std::string controller;  // "SR1/Walk"
  double period = 0.0;     // the time step [s]
  std::int64_t calls = 0;
  double median = 0.0;   // [s]
  double p999 = 0.0;     // 999 of 1000 calls take no longer [s]
  double longest = 0.0;  // [s]
  std::int64_t longest_tick = 0;
  std::vector<std::pair<double, std::int64_t>> histogram = {};  // upper end of each bin [s] with its calls; ascending
  std::optional<ControlCosts> costs = {};                       // none: they weren't counted
};

/// "control() of SR1/Walk is real-time safe in 10000 ticks: no allocation, ...", or the list of its costs.
std::string realtime_sentence(const ControlTimes& control);

/// The number so far, of the calling thread.
std::uint64_t page_faults_of_thread();

/// The result of a run.
struct RunSummary {
  std::int64_t ticks = 0;
  int channels = 0;
  std::int64_t pictures = 0;  // of colour and of depth
  std::uintmax_t bytes = 0;   // size of the trace file
  /// A controller threw, crashed or hung, or the simulation exploded: the run ended there.
  std::optional<Diagnostic> failure;
  RunEnding end = RunEnding::complete;
  bool trace_changed = false;       // something else has changed the trace while it was written; failure states how
  bool controller_refused = false;  // a controller returned false from configure, initialize or start
  /// Misbehaviour of controllers, and World::remarks(); warnings and errors.
  Diagnostics remarks;
  std::vector<ControlTimes> control_times;  // of the controllers that took part

  /// The failure, or the message of the controller that refused; null: the run is complete.
  const Diagnostic* ending() const {
    if (failure) return &*failure;
    for (const Diagnostic& remark : remarks)
      if (controller_refused && remark.severity == Severity::error) return &remark;
    return nullptr;
  }
};

/// A closed loop whose first part was taken from a golden.
struct ResumedRun {
  RunSummary summary;     // summary of the whole run
  std::int64_t from = 0;  // first tick that was simulated
};

/// The options of a world that moves by the commands of a recording.
struct PlantOptions {
  /// The tick at which to begin: a tick with a checkpoint, or 0. Cameras and range sensors deliver nothing that they
  /// captured before it.
  std::int64_t from = 0;  // tick
  /// The state at this tick is the last recorded state; nullopt: the state at the recording's last tick.
  std::optional<std::int64_t> until;
  /// The state is set back at each checkpoint; false: only at the first checkpoint.
  bool resync = true;
  /// The scenario whose sensor noise is used; null: the scenario that runs.
  const Scenario* noise_of = nullptr;
  /// Moves each body by a last bit wherever the state is set back, and at the beginning. The resulting differences are
  /// noise, not faults. See World::nudge().
  std::optional<std::uint32_t> nudge;
  /// Called about every hundredth of the run with the number of simulated ticks and the number of all ticks; null:
  /// never called.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// The result of a run of a world by recorded commands.
struct PlantSummary {
  std::int64_t ticks = 0;
  std::int64_t restored = 0;  // number of checkpoints at which the world was set back
  /// A sentence: why no checkpoint was restored; empty: checkpoints were restored, or not requested.
  std::string from_the_start;
  std::optional<Diagnostic> failure;  // the simulation exploded; the run ended there
};

/// Moves a scenario's world by the commands of a recording (session.h: run_plant).
using RunPlant = std::function<Result<PlantSummary>(const Scenario&, const Trace& recording,
                                                    const std::filesystem::path& trace, const PlantOptions&)>;

/// The functions of session.h, for libraries that don't link them.
struct Simulation {
  std::function<Result<RunSummary>(const Scenario&, const std::filesystem::path& trace, const RecordOptions&)> record;
  RunPlant run_plant;
  /// session.h: describe_plant. Null: nothing is proved, everything is simulated.
  std::function<Result<std::map<std::string, std::string>>(const Scenario&)> describe_plant = nullptr;
  /// session.h: record_from. Null: a run that is known to begin like its golden is simulated from the start.
  std::function<Result<ResumedRun>(const Scenario&, const Trace& golden, std::int64_t moment,
                                   const std::filesystem::path& trace, const RecordOptions&)>
      record_from = nullptr;
};

}  // namespace rehearse
