// JointGuide: the geometry of a joint between two bodies of ODE, and the equations that hold it. Private to the world
// library.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>

#include "solver/rows.h"

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

/// The poses of the two bodies of a joint.
struct JointPoses {
  const BodyPose& first;
  const BodyPose& second;
};

/// The equations are those of ODE's ball, hinge, slider and fixed joints (manual of ODE, 7.3 and 3.7), so that a direct
/// solution has the same velocities.
class JointGuide {
 public:
  using Type = LoopJoint::Type;

  /// The joint is in place at the bodies' current poses. `first` isn't null; if `second` is, it is the world.
  /// `anchor`: of fixed and prismatic joints unused [m]. `axis`: unit vector, of revolute and prismatic joints; world.
  JointGuide(Type type, dBodyID first, dBodyID second, const Eigen::Vector3d& anchor, const Eigen::Vector3d& axis);

  /// Adds the rows that hold the bodies together.
  void add_rows(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;
  /// The row of the joint's own motion, of a revolute or prismatic joint. The effort of a slider acts halfway between
  /// the centres of mass, as ODE's.
  Row axis_row(const JointPoses& poses, double target, double softness) const;

  /// Of a revolute joint: the first body's pose at that displacement [rad], counted from the poses at construction.
  BodyPose first_at(double displacement, const BodyPose& second) const;

  dBodyID first() const { return first_; }
  dBodyID second() const { return second_; }

 private:
  void hold_anchor(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;
  void hold_axis(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;
  void hold_rotation(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;
  void hold_line(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;
  void hold_center(const StepLaw& law, const JointPoses& poses, JointRows& rows) const;

  Type type_;
  dBodyID first_, second_;
  Eigen::Vector3d anchor_, axis_;                // in the first body's frame
  Eigen::Vector3d second_anchor_, second_axis_;  // in the second body's, or in the world
  Eigen::Vector3d offset_;       // of the first body's centre: from the second's, in its frame, or in the world [m]
  Eigen::Vector3d own_offset_;   // the same difference in the first body's frame [m]
  Eigen::Quaterniond relative_;  // of the second body in the first one's frame
};

}  // namespace rehearse
