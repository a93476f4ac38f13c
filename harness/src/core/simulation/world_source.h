// WorldSource: the source of observations from a simulated world, which the commands move.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <string>

#include "checkpoint_trial.h"
#include "core/replay/altered_inputs.h"
#include "core/run/run.h"
#include "plant.h"
#include "recorded_checkpoints.h"
#include "recorded_commands.h"
#include "world_remarks.h"

namespace rehearse {

class WorldSource : public ObservationSource {
 public:
  /// Remarks on the steps become events (WorldRemarks). Both must outlive this.
  WorldSource(const Scenario& scenario, Plant& plant) : plant_(plant), remarks_(scenario), trial_(scenario) {}

  /// WorldRemarks::add_idle_camera().
  void add_idle_camera(const std::string& controller, int body, int device) {
    remarks_.add_idle_camera(controller, body, device);
  }
  /// Saves a checkpoint every `interval` ticks; some are tested. 0: none.
  void save_checkpoints(std::int64_t interval) { checkpoint_interval_ = interval; }
  /// The result of these tests, for the outcome of a recording.
  std::string checkpoint_verdict() const { return checkpoint_interval_ > 0 ? trial_.verdict() : "none"; }
  /// Observations are altered from now on.
  void alter(AlteredInputs& altered) { altered_ = altered.empty() ? nullptr : &altered; }

  Result<bool> observe(TickData& now) override;
  Result<bool> advance(TickData& now, Commander& commands) override;

 private:
  void apply_alterations(TickData& now);

  Plant& plant_;
  WorldRemarks remarks_;
  AlteredInputs* altered_ = nullptr;
  Observation altered_seen_, altered_read_;
  std::int64_t checkpoint_interval_ = 0;  // [ticks]
  CheckpointTrial trial_;
};

/// Sets the world to the recorded state at the beginning of that tick, and devices to their settings at that time.
/// `command` becomes the command in force there. At tick 0 the world is not changed. False: there is no checkpoint at
/// the tick.
Result<bool> begin_at_checkpoint(std::int64_t tick, Plant& plant, RecordedCheckpoints& checkpoints,
                                 RecordedCommands& commands, Command& command);

}  // namespace rehearse
