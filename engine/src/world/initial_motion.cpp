#include "initial_motion.h"

#include <algorithm>
#include <cmath>

#include "simulated_body.h"

namespace rehearse {

std::vector<LinkMotion> initial_motions(const WorldBody& body, const std::vector<Eigen::Isometry3d>& poses) {
  const Model& model = *body.model;
  std::vector<LinkMotion> motions;
  motions.push_back({body.linear_velocity, body.angular_velocity});
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Joint& joint = model.links[i].joint;
    const auto parent = static_cast<std::size_t>(model.links[i].parent);
    LinkMotion motion = motions[parent];
    motion.velocity += motion.angular_velocity.cross(poses[i].translation() - poses[parent].translation());
    if (is_movable(joint.type) && !body.joint_velocities.empty()) {
      const double rate = body.joint_velocities[static_cast<std::size_t>(joint.id)];
      Eigen::Vector3d& of_joint = joint.type == JointType::prismatic ? motion.velocity : motion.angular_velocity;
      of_joint += rate * (poses[i].linear() * joint.axis);
    }
    motions.push_back(motion);
  }
  return motions;
}

Diagnostics check_velocities(const WorldBody& body, const std::string& name) {
  Diagnostics findings;
  const auto& rates = body.joint_velocities;
  const bool root_moves = !body.linear_velocity.isZero(0.0) || !body.angular_velocity.isZero(0.0);
  const bool joints_move = std::ranges::any_of(rates, [](double rate) { return rate != 0.0; });
  const bool is_finite = body.linear_velocity.allFinite() && body.angular_velocity.allFinite() &&
                         std::ranges::all_of(rates, [](double rate) { return std::isfinite(rate); });
  if (!rates.empty() && rates.size() != body.model->joints.size())
    findings.push_back(error(name + "the model has " + std::to_string(body.model->joints.size()) + " joints, but " +
                             std::to_string(rates.size()) + " initial velocities were given"));
  if (!is_finite) findings.push_back(error(name + "an initial velocity is not finite"));
  if (root_moves && root_is_fixed(body))
    findings.push_back(error(name + "the root link is fixed, so it has no initial velocity"));
  if (body.kinematic && (root_moves || joints_move))
    findings.push_back(error(name + "a kinematic body has no initial velocity", "its commands move it"));
  return findings;
}

}  // namespace rehearse
