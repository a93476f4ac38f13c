// JointMessages: reads the joints in messages of several types.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <functional>

#include "core/kinds/joint_arrays.h"
#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// The role of the messages, for types that have both.
enum class JointRole {
  measured,   // feedback, or actual
  commanded,  // output if it isn't empty, else reference, or desired
};

/// Reads JointState, JointTrajectory, JointTrajectoryControllerState and DynamicJointState as a JointState, by the
/// names of their fields:
/// - a JointTrajectory is its only point. A trajectory of several points commands a motion, not one set of values, and
///   isn't read;
/// - a DynamicJointState gives its interfaces position, velocity and effort; NaN where a joint has no such interface,
///   and an empty array if no joint has it.
class JointMessages {
 public:
  JointMessages(const ros2msg::Schema& schema, JointRole role);

  /// Valid until the next call. Errors: the payload doesn't fit the schema; a trajectory of several points; a
  /// DynamicJointState whose arrays have different lengths.
  Result<const JointArrays*> read(mcap::Bytes payload) { return read_(payload); }

 private:
  std::function<Result<const JointArrays*>(mcap::Bytes)> read_;
};

}  // namespace rehearse
