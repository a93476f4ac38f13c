// SimpleControllerIO: a controller enables here the quantities that it reads and commands.
//
// Enabling counts in initialize() only: after it the tables are fixed, and later calls have no effect.
//
//   actuation mode of the link                      enableInput(link)      enableOutput(link) sends
//   StateNone                                       nothing                nothing
//   JointEffort                                     q                      u
//   JointDisplacement                               q                      q_target
//   JointVelocity                                   q                      dq_target
//   any of these on a PseudoContinuousTrackJoint    nothing                as above
//   LinkPosition                                    nothing                T
//   LinkExtWrench                                   T                      F_ext
// Modes may be combined; then inputs and outputs are combined, too. The mode at the call determines the input, the mode
// at the end of initialize() determines the output. A null pointer throws std::invalid_argument. (Choreonoid would
// crash.)
#pragma once

#include "ControllerIO.h"

#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT SimpleControllerIO : public ControllerIO {
 public:
  ~SimpleControllerIO() override;

  /// Does the same as enableInput(link) and enableOutput(link).
  virtual void enableIO(Link* link) = 0;
  /// Inputs by the link's actuation mode, see above.
  virtual void enableInput(Link* link) = 0;
  /// `stateFlags`: Link::StateFlags, added to those of earlier calls.
  virtual void enableInput(Link* link, int stateFlags) = 0;
  /// The controller's device is refreshed before a control step whenever the simulated device has a new state.
  virtual void enableInput(Device* device) = 0;
  /// Outputs by the link's actuation mode, see above.
  virtual void enableOutput(Link* link) = 0;
  /// Sets the link's actuation mode to the flags and enables its output; with 0 only sets the mode.
  virtual void enableOutput(Link* link, int stateFlags) = 0;

  /// An object that a controller and its child controllers share under a name. T derives from Referenced.
  template <class T>
  T* getOrCreateSharedObject(const std::string& name) {
    return body()->getOrCreateCache<T>(name);
  }
  /// Null if there is no object of that name and type.
  template <class T>
  T* findSharedObject(const std::string& name) {
    return body()->findCache<T>(name);
  }

  // Names of earlier releases

  [[deprecated("Use controllerName.")]] std::string name() const { return controllerName(); }
  [[deprecated("Use enableInput for each joint.")]] virtual void setJointInput(int stateFlags);
  [[deprecated("Use enableOutput for each joint.")]] virtual void setJointOutput(int stateFlags);
  [[deprecated("Use enableInput.")]] virtual void setLinkInput(Link* link, int stateFlags);
  [[deprecated("Use enableOutput.")]] virtual void setLinkOutput(Link* link, int stateFlags);

  enum StateType {
    JOINT_DISPLACEMENT = Link::JointDisplacement,
    JOINT_ANGLE = Link::JointAngle,
    JOINT_VELOCITY = Link::JointVelocity,
    JOINT_ACCELERATION = Link::JointAcceleration,
    JOINT_FORCE = Link::JointForce,
    JOINT_TORQUE = Link::JointTorque,
    LINK_POSITION = Link::LinkPosition
  };
};

}  // namespace cnoid
