// OdeBody: one WorldBody as ODE simulates it. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/io.h>
#include <rehearse/world.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace rehearse {

/// Links that fixed joints hold together: one rigid body. Its frame is that of its first link; ODE's body frame has the
/// same axes and its origin at the centre of mass.
struct RigidGroup {
  dBodyID body = nullptr;  // null: fixed to the world
  int first_link = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // of mass, in the group's frame [m]
  Eigen::Isometry3d fixed_pose = Eigen::Isometry3d::Identity();    // of the group's frame, when it never moves
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // of the centre, over the last step [m/s²]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // over the last step [rad/s²]
  Eigen::Vector3d previous_velocity = Eigen::Vector3d::Zero();     // before the last step; scratch, not state
  Eigen::Vector3d previous_angular_velocity = Eigen::Vector3d::Zero();
};

/// Where a link sits in its group.
struct GroupedLink {
  int group = 0;
  Eigen::Isometry3d in_group = Eigen::Isometry3d::Identity();
  Eigen::Quaterniond rotation_in_group = Eigen::Quaterniond::Identity();
  bool leads_group = true;  // in_group is the identity
};

/// A movable joint: hinge or slider between two groups, or between a group and the world.
struct OdeJoint {
  dJointID joint = nullptr;
  int link = 0;  // the child
  bool revolute = true;
  int turns = 0;              // whole turns on top of ODE's angle, which lies in [-pi, pi]
  double wrapped = 0.0;       // ODE's angle after the last step [rad]
  double previous_dq = 0.0;   // before the last step; scratch, not state
  double applied = 0.0;       // effort added in the coming step, damping included [N·m] or [N]; scratch, not state
  bool motor_on = false;      // ODE's joint motor has a force limit above zero
  bool motor_drives = false;  // and it is the actuator, not dry friction
  std::unique_ptr<dJointFeedback> feedback;  // null unless somebody reads the joint's wrench
};

class OdeBody {
 public:
  /// Checks all that ODE would abort on. The messages begin with "body 'SR1': ".
  static Diagnostics check(const WorldBody& description);

  OdeBody(dWorldID world, WorldBody description, double time_step);
  ~OdeBody();
  OdeBody(const OdeBody&) = delete;
  OdeBody& operator=(const OdeBody&) = delete;

  /// Adds forces and sets motors for the coming step.
  void drive(const BodyCommand& command);
  void add_wrench(int link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque_about_origin);
  Eigen::Vector3d link_point(int link, const Eigen::Vector3d& point_in_link) const;

  /// Keeps the velocities of now, to take the difference after the step.
  void before_step();
  /// Accelerations, turns and force sensors from the step just done.
  void after_step();
  /// Fills the readings from the state.
  void observe(BodyObservation& observation, const Eigen::Vector3d& gravity, bool stepped) const;
  bool finite() const;

  /// Hands every piece of state to `visit(void*, size)`, in a fixed order; the one place that says what state is.
  /// `visit` may read or write. After writing, call after_restore().
  template <class Visit>
  void visit_state(Visit&& visit);
  void after_restore();

  const std::vector<dGeomID>& geoms() const { return geoms_; }
  const WorldBody& description() const { return description_; }

 private:
  void group_links();
  void create_groups(dWorldID world, const std::vector<Eigen::Isometry3d>& zero_posture);
  void create_joints(dWorldID world, const std::vector<Eigen::Isometry3d>& zero_posture);
  void create_geoms();
  void set_posture(const std::vector<Eigen::Isometry3d>& poses);
  dGeomID create_geom(const Geometry& geometry) const;
  double displacement(const OdeJoint& joint) const;
  double rate(const OdeJoint& joint) const;
  void set_motor(OdeJoint& joint, double velocity, double limit);
  void apply_effort(const OdeJoint& joint, double effort);
  Eigen::Vector3d world_axis(const OdeJoint& joint) const;
  Wrench child_wrench(const OdeJoint& joint) const;
  double motor_effort(const OdeJoint& joint) const;
  void measure(const Device& device, const BodyObservation& observation, const Eigen::Vector3d& gravity,
               DeviceReading& reading) const;

  WorldBody description_;
  double time_step_;
  std::vector<RigidGroup> groups_;
  std::vector<GroupedLink> links_;
  std::vector<OdeJoint> joints_;                       // by joint id
  std::vector<dGeomID> geoms_;                         // in link order, shapes in their link's order
  std::vector<double> efforts_;                        // by joint id, applied in the last step [N·m] or [N]
  std::vector<double> joint_accelerations_;            // by joint id, over the last step
  std::vector<Eigen::Matrix<double, 6, 1>> wrenches_;  // by device index; force sensors: measured in the last step
};

template <class Visit>
void OdeBody::visit_state(Visit&& visit) {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    // ODE hands out pointers to its own numbers. Its setters would normalise the quaternion and so change bits.
    visit(const_cast<dReal*>(dBodyGetPosition(group.body)), 3 * sizeof(dReal));
    visit(const_cast<dReal*>(dBodyGetQuaternion(group.body)), 4 * sizeof(dReal));
    visit(const_cast<dReal*>(dBodyGetRotation(group.body)), 12 * sizeof(dReal));
    visit(const_cast<dReal*>(dBodyGetLinearVel(group.body)), 3 * sizeof(dReal));
    visit(const_cast<dReal*>(dBodyGetAngularVel(group.body)), 3 * sizeof(dReal));
    visit(group.acceleration.data(), 3 * sizeof(double));
    visit(group.angular_acceleration.data(), 3 * sizeof(double));
  }
  for (OdeJoint& joint : joints_) {
    visit(&joint.turns, sizeof joint.turns);
    visit(&joint.wrapped, sizeof joint.wrapped);
  }
  visit(efforts_.data(), efforts_.size() * sizeof(double));
  visit(joint_accelerations_.data(), joint_accelerations_.size() * sizeof(double));
  for (auto& wrench : wrenches_) visit(wrench.data(), 6 * sizeof(double));
}

}  // namespace rehearse
