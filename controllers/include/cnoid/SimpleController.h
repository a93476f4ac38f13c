// SimpleController: the base class of a controller, and the macro that makes its library loadable.
//
//   class Hold : public cnoid::SimpleController { ... };
//   CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Hold)
//
// Order of calls: configure, initialize (simulation bodies exist), start (all controllers are initialized), then
// control once a step, stop, unconfigure. All on one thread.
#pragma once

#include "SimpleControllerConfig.h"
#include "SimpleControllerIO.h"
#include "SimulationSimpleControllerIO.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT SimpleController {
 public:
  using Factory = SimpleController* (*)();

  virtual ~SimpleController();
  SimpleController(const SimpleController&) = delete;
  SimpleController& operator=(const SimpleController&) = delete;

  /// Once, before the simulation. False: the controller can't run. Default: true.
  virtual bool configure(SimpleControllerConfig* config);
  /// Enable inputs and outputs here. False: the controller does not take part in the run. Default: true.
  virtual bool initialize(SimpleControllerIO* io);
  /// Called after initialize() of every controller. False: the controller does not take part in the run. Default: true.
  virtual bool start();
  /// Read inputs from the body and write commands to it. False means that the controller has finished; it is called
  /// again nevertheless. Default: false.
  virtual bool control();
  /// Called after the last step.
  virtual void stop();
  /// Called before and after a pause. Rehearse never pauses a run.
  virtual void pause();
  virtual bool resume();
  /// The counterpart of configure().
  virtual void unconfigure();

  /// Link's flags, for use without `Link::` in a controller.
  enum StateType {
    StateNone = Link::StateNone,
    JointDisplacement = Link::JointDisplacement,
    JointAngle = Link::JointAngle,
    JointVelocity = Link::JointVelocity,
    JointAcceleration = Link::JointAcceleration,
    JointEffort = Link::JointEffort,
    JointForce = Link::JointForce,
    JointTorque = Link::JointTorque,
    LinkPosition = Link::LinkPosition,
    LinkTwist = Link::LinkTwist,
    LinkAcceleration = Link::LinkAcceleration,
    LinkExtWrench = Link::LinkExtWrench,
    LinkContactState = Link::LinkContactState,

    JOINT_DISPLACEMENT = JointDisplacement,
    JOINT_ANGLE = JointAngle,
    JOINT_VELOCITY = JointVelocity,
    JOINT_SURFACE_VELOCITY = Link::DeprecatedJointSurfaceVelocity,
    JOINT_ACCELERATION = JointAcceleration,
    JOINT_EFFORT = JointEffort,
    JOINT_FORCE = JointForce,
    JOINT_TORQUE = JointTorque,
    LINK_POSITION = LinkPosition,
    LINK_FORCE = LinkExtWrench
  };

 protected:
  SimpleController();
};

}  // namespace cnoid

#define CNOID_SIMPLE_CONTROLLER_EXPORT CNOID_GENERAL_EXPORT

/// This number changes with the memory layout of these classes. A library that was compiled with a different number, or
/// with the headers of Choreonoid itself, would read and write at wrong places; it is refused.
#define REHEARSE_CNOID_ABI 3

/// The exported symbols of a controller's library: its factory, and the number it was compiled with.
extern "C" CNOID_SIMPLE_CONTROLLER_EXPORT cnoid::SimpleController* createSimpleController();
extern "C" CNOID_SIMPLE_CONTROLLER_EXPORT int rehearseCnoidAbi();

/// Defines both symbols. Write it once in a library, without a semicolon.
#define CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ControllerClass)                                \
  extern "C" CNOID_SIMPLE_CONTROLLER_EXPORT int rehearseCnoidAbi() { return REHEARSE_CNOID_ABI; } \
  extern "C" CNOID_SIMPLE_CONTROLLER_EXPORT cnoid::SimpleController* createSimpleController() {   \
    return new ControllerClass();                                                                 \
  }
