// InverseKinematics: interface of classes that can move a link to a pose.
#pragma once

#include "Config.h"
#include "EigenTypes.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT InverseKinematics {
 public:
  virtual ~InverseKinematics();

  /// Moves the joints so that the end link has the pose T in the world. False if that was not possible.
  virtual bool calcInverseKinematics(const Isometry3& T) = 0;
  [[deprecated("Use calcInverseKinematics(const Isometry3& T).")]] bool calcInverseKinematics(const Vector3& p,
                                                                                              const Matrix3& R);
  /// Computes forward kinematics of the links that a solution moved without being on its path. False if not supported.
  virtual bool calcRemainingPartForwardKinematicsForInverseKinematics();

  /// Best effort: if the goal can't be reached, stay at the nearest posture instead of returning to the start.
  virtual bool isBestEffortIkAvailable() const;
  virtual bool isBestEffortIkEnabled() const;
  virtual void setBestEffortIkEnabled(bool on);
  virtual int getDOF() const;
};

}  // namespace cnoid
