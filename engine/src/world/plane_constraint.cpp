#include "plane_constraint.h"

#include "ode_math.h"

namespace rehearse {
namespace {

constexpr double corrected_share = 0.2;  // of the drift, in a step

}  // namespace

using Eigen::Vector3d;

PlaneConstraint::PlaneConstraint(dWorldID world, dBodyID body)
    : body_(body),
      slide_(dJointCreateLMotor(world, nullptr)),
      turn_(dJointCreateAMotor(world, nullptr)),
      place_(dBodyGetPosition(body)[1]),
      normal_(rotation(dBodyGetRotation(body)).transpose() * Vector3d::UnitY()) {
  constexpr int in_world = 0;
  dJointAttach(slide_, body, nullptr);
  dJointSetLMotorNumAxes(slide_, 1);
  dJointSetLMotorAxis(slide_, 0, in_world, 0.0, 1.0, 0.0);
  dJointSetLMotorParam(slide_, dParamFMax, dInfinity);
  dJointAttach(turn_, body, nullptr);
  dJointSetAMotorMode(turn_, dAMotorUser);
  dJointSetAMotorNumAxes(turn_, 2);
  dJointSetAMotorAxis(turn_, 0, in_world, 1.0, 0.0, 0.0);
  dJointSetAMotorAxis(turn_, 1, in_world, 0.0, 0.0, 1.0);
  dJointSetAMotorParam(turn_, dParamFMax, dInfinity);
  dJointSetAMotorParam(turn_, dParamFMax2, dInfinity);
}

void PlaneConstraint::correct(double time_step) {
  const double rate = corrected_share / time_step;
  dJointSetLMotorParam(slide_, dParamVel, rate * (place_ - dBodyGetPosition(body_)[1]));
  const Vector3d tilt = (rotation(dBodyGetRotation(body_)) * normal_).cross(Vector3d::UnitY());
  dJointSetAMotorParam(turn_, dParamVel, rate * tilt.x());
  dJointSetAMotorParam(turn_, dParamVel2, rate * tilt.z());
}

JointMotion PlaneConstraint::motion() const {
  constexpr int slide_along_y = 1, turn_about_x = 3, turn_about_z = 5;
  JointMotion motion;
  motion.bias[slide_along_y] = dJointGetLMotorParam(slide_, dParamVel);
  motion.bias[turn_about_x] = dJointGetAMotorParam(turn_, dParamVel);
  motion.bias[turn_about_z] = dJointGetAMotorParam(turn_, dParamVel2);
  for (const int coordinate : {0, 2, 4}) motion.add(Vector6d::Unit(coordinate));
  return motion;
}

}  // namespace rehearse
