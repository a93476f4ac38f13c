// Lets a quadruped stand up from its knees and trot ahead: diagonal pairs of legs step in turn.
//
// Each foot follows a path in its leg's plane: on the ground it moves straight back, in the air it moves forward along
// half a wave. Inverse kinematics of the two-link leg gives the joints' angles, which proportional-derivative torques
// follow. Stepping begins when all feet have ground contact. The Imu's angular velocities, integrated with a short
// memory, are used to level the trunk: the legs on the lower side push up.
//
// Options: the speed [m/s]; default 0.3.

#include <algorithm>
#include <array>
#include <cmath>
#include <cnoid/Imu>
#include <cnoid/SimpleController>
#include <string>

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double segment = 0.21;      // of a leg: thigh, and shank to the foot's centre [m]
constexpr double half_length = 0.19;  // between front and rear hips [m]
constexpr double half_width = 0.14;   // between the left and the right feet [m]
constexpr double crouched = 0.2;      // hip above foot [m]
constexpr double standing = 0.34;     // hip above foot [m]
constexpr double rise_time = 0.8;     // [s]
constexpr double period = 0.4;        // in which each leg steps once [s]
constexpr double lift = 0.06;         // of a foot in the air [m]
constexpr double p_gain = 180.0;      // [N·m/rad]
constexpr double d_gain = 2.0;        // [N·m·s/rad]

/// From 0 to 1, with zero speed at both ends.
double smooth(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

class TrotController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    time_step_ = io->timeStep();
    const auto options = io->options();
    if (!options.empty()) speed_ = std::stod(options[0]);
    imu_ = io->body()->findDevice<cnoid::Imu>();
    if (!imu_) {
      io->os() << io->body()->modelName() << " has no Imu\n";
      return false;
    }
    io->enableInput(imu_);
    for (Leg& leg : legs_)
      if (!find(leg, io)) return false;
    return true;
  }

  bool control() override {
    roll_ += time_step_ * (imu_->w().x() - roll_ / lean_memory);
    pitch_ += time_step_ * (imu_->w().y() - pitch_ / lean_memory);
    rise_ = std::min(1.0, rise_ + time_step_ / rise_time);
    if (rise_ == 1.0 && (walks_ || all_feet_touch())) {
      walks_ = true;
      cycles_ += time_step_ / period;
    }
    const double height = crouched + (standing - crouched) * smooth(rise_);
    const double stride =
        smooth(cycles_ / 2.0) * speed_ * period / 2.0;  // on the ground half of the time; short at first
    for (Leg& leg : legs_) {
      const double phase = cycles_ + leg.phase - std::floor(cycles_ + leg.phase);
      if (!walks_) {
        hold(leg, 0.0, height);
      } else if (phase < 0.5) {
        hold(leg, stride * (0.5 - 2.0 * phase), height);
      } else {
        const double s = 2.0 * phase - 1.0;
        hold(leg, stride * (smooth(s) - 0.5), height - lift * std::sin(pi * s));
      }
    }
    return true;
  }

 private:
  static constexpr double lean_memory = 1.0;  // [s]

  struct Leg {
    std::string name;
    double phase;  // equal for both legs of a diagonal pair
    double side;   // 1: left, -1: right
    double end;    // 1: front, -1: rear
    std::array<cnoid::Link*, 3> joints{};
    std::array<double, 3> wanted{};  // in the last tick [rad]
    bool was_held = false;
    cnoid::Link* foot = nullptr;
  };

  static bool find(Leg& leg, cnoid::SimpleControllerIO* io) {
    const std::array<const char*, 3> parts{"_ABDUCTION", "_THIGH", "_KNEE"};
    for (std::size_t i = 0; i < parts.size(); ++i) {
      leg.joints[i] = io->body()->joint(leg.name + parts[i]);
      if (!leg.joints[i]) {
        io->os() << io->body()->modelName() << " has no joint " << leg.name << parts[i] << "\n";
        return false;
      }
      leg.joints[i]->setActuationMode(JointTorque);
      io->enableInput(leg.joints[i], JointAngle | JointVelocity);  // enableIO() gives the angle only
      io->enableOutput(leg.joints[i]);
    }
    leg.foot = io->body()->link(leg.name + "_FOOT");
    if (!leg.foot) {
      io->os() << io->body()->modelName() << " has no link " << leg.name << "_FOOT\n";
      return false;
    }
    io->enableInput(leg.foot, LinkContactState);
    return true;
  }

  bool all_feet_touch() const {
    return std::all_of(legs_.begin(), legs_.end(), [](const Leg& leg) { return !leg.foot->contactPoints().empty(); });
  }

  /// Torques towards the angles that bring the foot x ahead of the hip and `reach` below it [m].
  void hold(Leg& leg, double x, double reach) const {
    reach += half_length * leg.end * pitch_ - half_width * leg.side * roll_;
    const double distance = std::clamp(std::hypot(x, reach), 0.1, 1.99 * segment);
    const double bend = std::acos(distance / (2.0 * segment));  // between the thigh and the line to the foot
    const std::array<double, 3> wanted{0.0, std::atan2(-x, reach) + bend, -2.0 * bend};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      cnoid::Link* joint = leg.joints[i];
      const double wanted_speed = leg.was_held ? (wanted[i] - leg.wanted[i]) / time_step_ : 0.0;  // [rad/s]
      joint->u() = p_gain * (wanted[i] - joint->q()) + d_gain * (std::clamp(wanted_speed, -8.0, 8.0) - joint->dq());
    }
    leg.wanted = wanted;
    leg.was_held = true;
  }

  std::array<Leg, 4> legs_{
      {{"FL", 0.0, 1.0, 1.0}, {"FR", 0.5, -1.0, 1.0}, {"RL", 0.5, 1.0, -1.0}, {"RR", 0.0, -1.0, -1.0}}};
  cnoid::Imu* imu_ = nullptr;
  double speed_ = 0.3;               // [m/s]
  double time_step_ = 0.0;           // [s]
  double roll_ = 0.0, pitch_ = 0.0;  // of the trunk, integrated with a short memory [rad]
  double rise_ = 0.0;                // progress of standing up, 0 to 1
  bool walks_ = false;
  double cycles_ = 0.0;  // of all legs
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TrotController)
