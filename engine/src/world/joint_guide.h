// JointGuide: the geometry of a joint between two bodies of ODE, and the equations that hold it. Private to the world
// library.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>

#include "solver/joint_motion.h"

namespace rehearse {

/// How a step corrects a joint's error, and how much a constraint yields.
struct StepLaw {
  double time_step = 0.0;        // [s]
  double correction_rate = 0.0;  // ODE's error reduction parameter divided by the time step [1/s]
  double softness = 0.0;         // ODE's constraint force mixing divided by the time step
};

/// The pose of one of ODE's bodies; of the world, the identity.
struct BodyPose {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of mass [m]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Quaterniond quaternion = Eigen::Quaterniond::Identity();

  /// `body` is null for the world.
  static BodyPose of(dBodyID body);
};

/// A body of ODE at the beginning of a step; the world is at rest.
struct BodyMotion : BodyPose {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // of the centre of mass [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s]

  static BodyMotion of(dBodyID body);
};

/// The two bodies of a joint.
struct JointBodies {
  const BodyMotion& first;
  const BodyMotion& second;
};

/// The equations are those of ODE's ball, hinge, slider and fixed joints (manual of ODE, 7.3 and 3.7), and the rate at
/// which they turn with the bodies. ODE leaves that out and corrects it as an error, a share in each step. A step's
/// velocities belong to its middle, since positions move by them, and the equations to its beginning. So half of what
/// the turning adds in a step is part of their right sides.
class JointGuide {
 public:
  using Type = LoopJoint::Type;
  static constexpr std::size_t most_rows = 6;
  using Rows = RowList<most_rows>;

  /// The joint is in place at the bodies' current poses. `first` isn't null; if `second` is, it is the world.
  /// `anchor`: of fixed and prismatic joints unused [m]. `axis`: unit vector, of revolute and prismatic joints; world.
  JointGuide(Type type, dBodyID first, dBodyID second, const Eigen::Vector3d& anchor, const Eigen::Vector3d& axis);

  /// Adds the rows that hold the bodies together.
  void add_rows(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;
  /// The same of a revolute or prismatic joint, for the first body as a function of the second. The coordinate of a
  /// slider is that of the centres of mass, with half of the angular velocity of each body.
  JointMotion motion(const StepLaw& law, const JointBodies& bodies) const;
  /// The rate of that coordinate.
  double rate(const JointBodies& bodies) const;

  /// Of a revolute joint: the first body's pose at that displacement [rad], counted from the poses at construction.
  BodyPose first_at(double displacement, const BodyPose& second) const;

  dBodyID first() const { return first_; }
  dBodyID second() const { return second_; }

 private:
  /// The velocities that correct the errors, and half of what the turning of the equations adds.
  Eigen::Vector3d anchor_target(const StepLaw& law, const JointBodies& bodies) const;
  Eigen::Vector3d axis_target(const StepLaw& law, const JointBodies& bodies) const;
  Eigen::Vector3d rotation_target(const StepLaw& law, const JointBodies& bodies) const;
  Eigen::Vector3d line_target(const StepLaw& law, const JointBodies& bodies) const;
  /// From the second body's centre of mass to the first one's; 0 for the world.
  Eigen::Vector3d between(const JointBodies& bodies) const;

  void hold_anchor(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;
  void hold_axis(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;
  void hold_rotation(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;
  void hold_line(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;
  void hold_center(const StepLaw& law, const JointBodies& bodies, Rows& rows) const;

  Type type_;
  dBodyID first_, second_;
  Eigen::Vector3d anchor_, axis_;                // in the first body's frame
  Eigen::Vector3d second_anchor_, second_axis_;  // in the second body's, or in the world
  Eigen::Vector3d offset_;       // of the first body's centre: from the second's, in its frame, or in the world [m]
  Eigen::Vector3d own_offset_;   // the same difference in the first body's frame [m]
  Eigen::Quaterniond relative_;  // of the second body in the first one's frame
};

}  // namespace rehearse
