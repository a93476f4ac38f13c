#include "cut.h"

#include "ode_math.h"

namespace rehearse {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PartBehind part_behind(const Model& model, const RigidGroups& groups, int link) {
  PartBehind part;
  part.holds.assign(model.links.size(), false);
  const auto count = static_cast<int>(model.links.size());
  for (int i = link; i < count; ++i) {  // parents come before their children
    const GroupedLink& grouped = groups.links[i];
    const int parent = model.links[i].parent;
    part.holds[i] = i == link || (!grouped.leads_group && parent >= 0 && part.holds[parent]);
    if (!part.holds[i]) continue;
    const Inertial in_group = moved(model.links[i].inertial, grouped.in_group);
    part.inertial = sum(part.inertial, in_group);
    if (model.links[i].has_weight) part.weight = sum(part.weight, in_group);
  }
  return part;
}

Wrench wrench_to_move(const PartBehind& part, const GroupMotion& motion, const Vector3d& gravity,
                      const Vector3d& origin) {
  const Vector3d &w = motion.angular_velocity, &dw = motion.angular_acceleration;
  const Vector3d center = motion.frame * part.inertial.center;
  const Vector3d arm = center - motion.center;
  const Vector3d acceleration = acceleration_at(arm, motion.acceleration, w, dw);
  const Matrix3d inertia = motion.frame.linear() * part.inertial.inertia * motion.frame.linear().transpose();
  const Vector3d weight = part.weight.mass * gravity;
  const Vector3d inertial_force = part.inertial.mass * acceleration;
  Wrench wrench;
  wrench.force = inertial_force - weight;
  wrench.torque = (center - origin).cross(inertial_force) + inertia * dw + w.cross(inertia * w) -
                  (motion.frame * part.weight.center - origin).cross(weight);
  return wrench;
}

}  // namespace rehearse
