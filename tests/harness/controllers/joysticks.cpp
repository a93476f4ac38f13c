// Controllers that read a joystick.

#include <cnoid/SharedJoystick>

#include <cstdlib>
#include <stdexcept>

#include "behaviours.h"

namespace behaviours {
namespace {

using cnoid::Joystick;
using cnoid::SharedJoystick;

/// The state of a joystick in one number: L_STICK_V, 10 for button A, 100 for R_TRIGGER.
double sum_of(const cnoid::JoystickInterface& joystick) {
  return joystick.getPosition(Joystick::L_STICK_V_AXIS) + (joystick.getButtonState(Joystick::A_BUTTON) ? 10.0 : 0.0) +
         100.0 * joystick.getPosition(Joystick::R_TRIGGER_AXIS);
}

/// steer: commands the state of its joystick, which it creates in its constructor. Writes its state in initialize().
class Steered : public Pusher {
 public:
  explicit Steered(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->os() << (joystick_.isReady() ? "ready" : "not ready") << ", " << joystick_.numAxes() << " axes, "
             << joystick_.numButtons() << " buttons\n";
    return Pusher::initialize(io);
  }
  bool control() override {
    joystick_.readCurrentState();
    effort_ = sum_of(joystick_);
    return Pusher::control();
  }

 private:
  Joystick joystick_;
};
const Add<Steered> steered("steer");

/// steer_late: looks for a joystick again in each control().
class SteeredLate : public Pusher {
 public:
  explicit SteeredLate(const Words&) : Pusher(0.0) {}
  bool control() override {
    Joystick joystick;
    joystick.readCurrentState();
    effort_ = sum_of(joystick);
    return Pusher::control();
  }
};
const Add<SteeredLate> steered_late("steer_late");

/// steer_once: reads its joystick in tick 5 only.
class SteeredOnce : public Pusher {
 public:
  explicit SteeredOnce(const Words&) : Pusher(0.0) {}
  bool control() override {
    if (tick_ == 5) joystick_.readCurrentState();
    effort_ = sum_of(joystick_);
    return Pusher::control();
  }

 private:
  Joystick joystick_;
};
const Add<SteeredOnce> steered_once("steer_once");

/// share JOINT: commands the joint the state of a joystick that it shares with its children, or its parent, while its
/// mode is active.
class Sharer : public cnoid::SimpleController {
 public:
  explicit Sharer(const Words& words) : joint_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    link_ = io->body()->joint(joint_);
    io->enableOutput(link_, cnoid::Link::JointEffort);
    joystick_ = io->getOrCreateSharedObject<SharedJoystick>("joystick");
    mode_ = joystick_->addMode();
    return true;
  }
  bool control() override {
    joystick_->updateState(mode_);
    link_->u() = joystick_->getPosition(mode_, Joystick::L_STICK_V_AXIS, 0.1);
    return true;
  }

 private:
  std::string joint_;
  cnoid::Link* link_ = nullptr;
  cnoid::SharedJoystickPtr joystick_;
  int mode_ = 0;
};
const Add<Sharer> sharer("share");

/// listen [throw|abort]: writes its joystick's signals, or fails at the first button. It never disconnects its slots.
class SignalListener : public Pusher {
 public:
  explicit SignalListener(const Words& words) : Pusher(0.0), failure_(words.empty() ? "" : words[0]) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Pusher::initialize(io);
    joystick_.sigAxis().connect([this](int axis, double position) {
      io_->os() << "axis " << axis << " at " << position << ", active " << joystick_.isActive() << "\n";
    });
    joystick_.sigButton().connect([this](int button, bool pressed) {
      if (failure_ == "throw") throw std::runtime_error("a button");
      if (failure_ == "abort") std::abort();
      io_->os() << "button " << button << (pressed ? " pressed" : " let go") << "\n";
    });
    return true;
  }
  bool control() override {
    joystick_.readCurrentState();
    return Pusher::control();
  }

 private:
  std::string failure_;
  Joystick joystick_;
};
const Add<SignalListener> signal_listener("listen");

}  // namespace
}  // namespace behaviours
