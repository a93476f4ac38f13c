// A person drives a tank by joystick: its tracks by the left stick, its turret and gun by the right one, its light by
// buttons.
//
// A switches the light on and off, X narrows its beam and Y widens it. Option: the drive of turret and gun, "torque"
// (the default: a proportional-derivative law in this file) or "position".

#include <algorithm>
#include <cmath>
#include <cnoid/Joystick>
#include <cnoid/SimpleController>
#include <cnoid/SpotLight>
#include <string>

namespace {

using cnoid::Joystick;

constexpr double top_speed = 0.8;       // of the tracks [m/s]
constexpr double turret_rate = 1.0;     // with the stick at its end [rad/s]
constexpr float beam_rate = 0.4f;       // [rad/s]
constexpr float narrowest_beam = 0.1f;  // [rad]
constexpr float widest_beam = 0.7f;     // [rad]

/// A joint whose target is moved by a stick.
struct Aim {
  const char* name;
  int axis;
  double p_gain;  // [N·m/rad]
  double d_gain;  // [N·m·s/rad]
  cnoid::Link* joint = nullptr;
  double target = 0.0;  // [rad]
};

class TankController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    const auto options = io->options();
    by_position_ = !options.empty() && options[0] == "position";
    cnoid::Body* body = io->body();
    for (cnoid::Link** track : {&left_, &right_}) {
      *track = body->joint(track == &left_ ? "TRACK_L" : "TRACK_R");
      if (!*track) return io->os() << body->modelName() << " has no tracks\n", false;
      io->enableOutput(*track, JointVelocity);
    }
    for (Aim& aim : aims_) {
      aim.joint = body->joint(aim.name);
      if (!aim.joint) return io->os() << body->modelName() << " has no joint " << aim.name << "\n", false;
      aim.target = aim.joint->q();
      aim.joint->setActuationMode(by_position_ ? JointDisplacement : JointTorque);
      io->enableInput(aim.joint, JointDisplacement | JointVelocity);
      io->enableOutput(aim.joint);
    }
    light_ = body->findDevice<cnoid::SpotLight>();
    if (light_) {
      light_->on(false);
      light_->notifyStateChange();
    }
    if (!joystick_.makeReady()) io->os() << "there is no joystick: the tank stays where it is\n";
    return true;
  }

  bool control() override {
    joystick_.readCurrentState();
    const double ahead = -joystick_.getPosition(Joystick::L_STICK_V_AXIS);  // up is negative
    const double turn = -joystick_.getPosition(Joystick::L_STICK_H_AXIS);   // to the left
    left_->dq_target() = top_speed * std::clamp(ahead - turn, -1.0, 1.0);
    right_->dq_target() = top_speed * std::clamp(ahead + turn, -1.0, 1.0);
    for (Aim& aim : aims_) drive(aim);
    if (light_) switch_light();
    return true;
  }

 private:
  void drive(Aim& aim) {
    // right is positive on the stick and negative about z; up is negative on both
    const double sign = aim.axis == Joystick::R_STICK_H_AXIS ? -1.0 : 1.0;
    aim.target += sign * turret_rate * joystick_.getPosition(aim.axis) * io_->timeStep();
    aim.target = std::clamp(aim.target, aim.joint->q_lower(), aim.joint->q_upper());
    if (by_position_)
      aim.joint->q_target() = aim.target;
    else
      aim.joint->u() = aim.p_gain * (aim.target - aim.joint->q()) - aim.d_gain * aim.joint->dq();
  }

  void switch_light() {
    const bool pressed = joystick_.getButtonState(Joystick::A_BUTTON);
    const bool toggled = pressed && !was_pressed_;
    was_pressed_ = pressed;
    const float change = beam_rate * static_cast<float>(io_->timeStep());
    float width = light_->beamWidth();
    if (joystick_.getButtonState(Joystick::X_BUTTON)) width = std::max(narrowest_beam, width - change);
    if (joystick_.getButtonState(Joystick::Y_BUTTON)) width = std::min(widest_beam, width + change);
    if (!toggled && width == light_->beamWidth()) return;
    if (toggled) light_->on(!light_->on());
    light_->setBeamWidth(width);
    light_->setCutOffAngle(1.2f * width);
    light_->notifyStateChange();
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  Joystick joystick_;
  cnoid::Link* left_ = nullptr;
  cnoid::Link* right_ = nullptr;
  Aim aims_[2] = {{"TURRET_Y", Joystick::R_STICK_H_AXIS, 60.0, 6.0}, {"TURRET_P", Joystick::R_STICK_V_AXIS, 60.0, 3.0}};
  bool by_position_ = false;
  cnoid::SpotLightPtr light_;
  bool was_pressed_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TankController)
