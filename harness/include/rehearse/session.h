// Session: one closed-loop run of a scenario: sense, control, actuate, step, and all of it recorded.
//
// Needs the simulation (ODE, and OSMesa if a camera runs). For recorded inputs without simulation: replay.h.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace rehearse {

struct RecordOptions : HostOptions {
  /// Simulated time from one checkpoint to the next [s]; at least a tick; 0: there are none, and the plant level of a
  /// check runs from the start.
  double checkpoint_period = 0.1;
  /// Moves each body by a last bit before the first tick, to see how far that carries. See World::nudge().
  std::optional<std::uint32_t> nudge;
  /// Called about every hundredth of the run with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// What a run came to.
struct RunSummary {
  std::int64_t ticks = 0;
  int channels = 0;
  std::int64_t frames = 0;            // colour pictures
  std::uintmax_t bytes = 0;           // of the trace file
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung, or the simulation exploded: it ended there
  bool controller_refused = false;    // a controller returned false from configure, initialize or start
  Diagnostics remarks;  // what controllers did that they should not have, and World::remarks(); warnings and errors
};

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

}  // namespace rehearse
