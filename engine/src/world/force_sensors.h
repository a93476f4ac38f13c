// ForceSensors: the wrenches that the links behind joints exert on the links before them. Private to the world library.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "cut.h"
#include "model/rigid_groups.h"
#include "ode_joint.h"
#include "rigid_group.h"
#include "simulated_body.h"

namespace rehearse {

/// All force sensors of a body. ODE reports the wrench of a movable joint. At a fixed joint, and at a track's, both
/// sides are one rigid body: there the wrench is that which the part behind the joint needs for its motion.
class ForceSensors {
 public:
  /// `joint`: the movable joint of that id, which must outlive this.
  ForceSensors(const Model& model, const RigidGroups& groups, const std::function<OdeJoint&(int id)>& joint);

  /// Links whose contacts must be measured.
  const std::vector<int>& feeling_links() const { return feeling_links_; }
  /// Stores the poses at the beginning of a step, when its forces begin to act.
  void begin_step(const std::vector<RigidGroup>& groups);
  /// A push or command on a link in this step [N, N·m]; the torque is about the world's origin.
  void add_wrench(int link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque);
  /// Measures the step. `gravity` [m/s²].
  void measure(const Model& model, const std::vector<RigidGroup>& groups, const std::vector<Touch>& touches,
               const Eigen::Vector3d& gravity);
  /// Force [N] and torque [N·m] in the sensor's frame, measured in the last step; `device`: index in the model.
  void read(std::size_t device, std::vector<double>& values) const;
  void visit_state(const std::string& body, const Model& model, StateVisitor& visitor);

 private:
  struct JointSensor {
    std::size_t device = 0;
    const OdeJoint* joint = nullptr;
  };
  struct CutSensor {
    std::size_t device = 0;
    PartBehind part;
    struct Child {
      int link = 0;
      const OdeJoint* joint = nullptr;
    };
    std::vector<Child> children;  // movable, behind links of the part
    Wrench external;              // of pushes and commands on the part in this step
  };

  void measure_joint(const JointSensor& sensor, const Device& device);
  void measure_cut(const CutSensor& cut, const Device& device, const RigidGroup& group,
                   const std::vector<Touch>& touches, const Eigen::Vector3d& gravity);
  const GroupMotion& motion_of(int link) const { return motions_[static_cast<std::size_t>(links_[link].group)]; }

  std::vector<GroupedLink> links_;
  std::vector<JointSensor> joint_sensors_;
  std::vector<CutSensor> cuts_;
  std::vector<int> feeling_links_;
  std::vector<Eigen::Matrix<double, 6, 1>> wrenches_;  // by device index
  std::vector<GroupMotion> motions_;  // at the beginning of the step, by group; empty: the body has no force sensors
};

}  // namespace rehearse
