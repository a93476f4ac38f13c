#include <rehearse/actuator.h>
#include <rehearse/model.h>

#include <algorithm>

namespace rehearse {

EffortRange effort_range(const Actuator& actuator, double velocity) {
  EffortRange range;
  if (actuator.stall_effort && actuator.no_load_velocity) {
    const double slope = *actuator.stall_effort / *actuator.no_load_velocity;
    range = {-*actuator.stall_effort - slope * velocity, *actuator.stall_effort - slope * velocity};
  }
  if (!actuator.effort) return range;
  return {std::clamp(range.lower, -*actuator.effort, *actuator.effort),
          std::clamp(range.upper, -*actuator.effort, *actuator.effort)};
}

Joint joint_with(const Actuator& actuator, Joint joint) {
  joint.effort = actuator.effort.value_or(joint.effort);
  joint.velocity = actuator.velocity.value_or(joint.velocity);
  joint.armature = actuator.armature.value_or(joint.armature);
  joint.damping = actuator.damping.value_or(joint.damping);
  joint.friction = actuator.coulomb.value_or(joint.friction);
  return joint;
}

}  // namespace rehearse
