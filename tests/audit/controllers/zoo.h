// Base class of the zoo's controllers: a pendulum held by a spring, and a term that each controller computes
// differently.
#pragma once

#include <cnoid/SimpleController>

#include <string>

class ZooController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(joint_);
    return begin();
  }

  bool control() override {
    joint_->u() = -2.0 * joint_->q() + term();  // [N·m/rad]
    return true;
  }

 protected:
  virtual bool begin() { return true; }
  virtual double term() = 0;  // [N·m]

  std::string options() const { return io_->optionString(); }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* joint_ = nullptr;
};
