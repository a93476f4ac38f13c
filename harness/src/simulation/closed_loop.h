// ClosedLoop: sense, control, actuate, step, and all of it recorded. What a session runs, and what a branch of a
// recording runs from its moment on.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "checkpoint_trial.h"
#include "host/controller_host.h"
#include "host/process_guard.h"
#include "plant.h"
#include "recording/recorder.h"
#include "replay/altered_inputs.h"

namespace rehearse {

struct ClosedLoop {
  const Scenario& scenario;
  std::unique_ptr<Plant> plant;
  std::unique_ptr<ControllerHost> host;
  std::unique_ptr<Recorder> recorder;
  std::optional<ProtectedDescriptor> descriptor;  // the recorder's
  std::filesystem::path file;
  Command command;
  std::int64_t checkpoint_interval = 0;  // [ticks]; 0: none
  CheckpointTrial trial;
  AlteredInputs altered;
  RunSummary summary;

  explicit ClosedLoop(const Scenario& of) : scenario(of), trial(of) {}

  /// Plant and controllers, and the file with what is known before the run. `trace` is that file.
  Result<void> create(const std::filesystem::path& trace, const HostOptions& options);
  /// The controllers have been initialised: what they want to know of the world is watched.
  void watch_contacts();
  Result<void> record_events();
  /// One tick. False: the run is over, by its duration or by a failure.
  Result<bool> step();
  /// stop() of the controllers, the last state, the trace's end.
  Result<RunSummary> finish();

 private:
  Result<void> save_checkpoint();
  void look();
  Result<void> record_tick(std::int64_t tick);
  void tell_ode_messages(std::int64_t tick);
  Diagnostics stopped_recording(Diagnostics errors) const;

  // What is recorded, and what controllers read: the plant's own, or copies that were altered.
  const Observation* seen_ = nullptr;
  const Observation* read_ = nullptr;
  Observation altered_seen_, altered_read_;
  bool told_ode_messages_ = false;
};

}  // namespace rehearse
