// PlaneConstraint: keeps a rigid body in the plane of x and z. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "joint_guide.h"

namespace rehearse {

/// The body neither moves along y nor turns about x and z. Two motors of velocity 0 do it, which also correct drift;
/// ODE's own joint of a plane keeps z at 0. Everything that the motors depend on is in the body's state.
class PlaneConstraint {
 public:
  /// The plane and the direction in the body are those of its present pose.
  PlaneConstraint(dWorldID world, dBodyID body);

  /// To be called before each step.
  void correct(double time_step);
  /// How the body may move, for the direct solver, after correct().
  JointMotion motion() const;

 private:
  dBodyID body_;
  dJointID slide_, turn_;
  double place_;            // of the plane along y [m]
  Eigen::Vector3d normal_;  // of the plane, in the body's frame
};

}  // namespace rehearse
