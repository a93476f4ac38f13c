// The faults of an actuator in one step. Used by its simulation, and where a command is examined without physics.
#pragma once

#include <rehearse/actuator.h>
#include <rehearse/io.h>

#include <vector>

namespace rehearse {

/// True if a fault of from <= t < until acts in the step that begins at `time`. Times within a billionth of a step of
/// its ends are at them [s].
bool acts(double from, double until, double time, double time_step);

/// A command under faults.
struct FaultedCommand {
  JointCommand command;
  double factor = 1.0;       // of efforts
  double drive_share = 1.0;  // of the effort limit of a drive without a loop
  bool is_locked = false;    // the joint stays where it is, whatever the command
};

/// `time`: of the step's beginning [s].
FaultedCommand under_faults(const std::vector<ActuatorFault>& faults, JointCommand command, double time,
                            double time_step);

}  // namespace rehearse
