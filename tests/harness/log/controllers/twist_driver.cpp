// Drives a robot with two wheels by the velocities that a program sends to turtlesim: a Twist as the axes of a
// joystick.
#include <cnoid/Joystick>
#include <cnoid/SimpleController>

namespace {

constexpr int linear_x = 0, angular_z = 5;  // axes
constexpr double half_track = 0.25;         // [m]

class TwistDriver : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    left_ = io->body()->joint("LEFT_WHEEL");
    right_ = io->body()->joint("RIGHT_WHEEL");
    if (!left_ || !right_) return io->os() << "the robot has no wheels\n", false;
    for (cnoid::Link* wheel : {left_, right_}) {
      wheel->setActuationMode(JointVelocity);
      io->enableOutput(wheel);
    }
    return joystick_.makeReady();
  }

  bool control() override {
    joystick_.readCurrentState();
    const double ahead = joystick_.getPosition(linear_x), turn = joystick_.getPosition(angular_z);
    left_->dq_target() = ahead - turn * half_track;
    right_->dq_target() = ahead + turn * half_track;
    return true;
  }

 private:
  cnoid::Link* left_ = nullptr;
  cnoid::Link* right_ = nullptr;
  cnoid::Joystick joystick_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TwistDriver)
