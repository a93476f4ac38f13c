// ClosedLoop: world and controllers in a loop, and a recording of both. It is used by a session, and by a branch of a
// recording from its moment on.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/guard/process_guard.h"
#include "core/host/controller_host.h"
#include "core/recording/recorder.h"
#include "core/replay/altered_inputs.h"
#include "core/run/hosted_commands.h"
#include "core/run/recording_sink.h"
#include "plant.h"
#include "world_source.h"

namespace rehearse {

struct ClosedLoop {
  const Scenario& scenario;
  std::unique_ptr<Plant> plant;
  std::unique_ptr<ControllerHost> host;
  std::unique_ptr<Recorder> recorder;
  std::optional<ProtectedDescriptor> descriptor;  // the recorder's
  std::filesystem::path file;
  AlteredInputs altered;
  std::optional<WorldSource> world;
  std::optional<HostedCommands> commands;
  std::optional<RecordingSink> sink;
  std::optional<Run> run;
  RunSummary summary;

  explicit ClosedLoop(const Scenario& of) : scenario(of) {}
  ClosedLoop(const ClosedLoop&) = delete;
  ClosedLoop& operator=(const ClosedLoop&) = delete;

  /// Creates plant and controllers, and the file with the data known before the run. `trace` is that file.
  Result<void> create(const std::filesystem::path& trace, const HostOptions& options);
  /// Calls initialize() of the controllers. Afterwards the world watches the links whose contacts they read, and the
  /// run's command is at rest.
  void initialize();
  /// Adds the channels of the recording and calls start() of the controllers.
  void start();
  /// Makes one tick. False: the run is over, by its duration or by a failure.
  Result<bool> step();
  /// Calls stop() of the controllers, records the last state and closes the trace.
  Result<RunSummary> finish();
  /// Closes the loop at the run's present tick, up to which the controllers were fed from a recording. Makes all
  /// remaining ticks, and finishes. `led`: the command that moved the world to this tick; it stays in force, but joints
  /// have the drives of the present controllers. `interval`: of the checkpoints [ticks]; 0: none. `progress`: as for
  /// Run::report_progress(), of the remaining ticks.
  Result<RunSummary> go_on(Command led, std::int64_t interval, Run::Progress progress);

 private:
  std::optional<Diagnostic> failure() const;
  RunEnding end() const;
  Result<void> close_file();
  Diagnostics stopped_recording(Diagnostics errors) const;
};

}  // namespace rehearse
