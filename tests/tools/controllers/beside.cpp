// A controller of the quadruped with eleven faults to choose from: FAULT is the number of one, or 0. The comment
// "fault N" marks the line that --beside is to name.
#include <cnoid/Imu>
#include <cnoid/SimpleController>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#ifndef FAULT
#define FAULT 0
#endif

namespace {

struct Leg {
  std::array<cnoid::Link*, 3> joints{};
  double side = 1.0;  // left: 1, right: -1
  double filtered = 0.0;
};

struct Joint {
  std::string name;
};

class Beside : public cnoid::SimpleController {
 public:
  Beside() {}  // without it, all members would be zero at first

  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (int leg = 0; leg < 4; ++leg) {
      legs_.emplace_back();
      legs_.back().side = leg % 2 == 0 ? 1.0 : -1.0;
#if FAULT == 1
      if (leg == 2) legs_.back().side = -1.0;  // fault 1: the sign of one leg
#endif
      for (int joint = 0; joint < 3; ++joint) {
        cnoid::Link* link = io->body()->joint(3 * leg + joint);
        link->setActuationMode(cnoid::Link::JointEffort);
        io->enableInput(link, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
        io->enableOutput(link);
        legs_.back().joints[joint] = link;
      }
    }
    imu_ = io->body()->findDevice<cnoid::Imu>();
    io->enableInput(imu_);
    time_step_ = io->timeStep();
#if FAULT != 10
    lean_ = 0.0;
#endif
    return true;
  }

  bool control() override {
    for (const Joint& joint : joints_) longest_ = std::max(longest_, joint.name.size());
    lean_ += 0.01 * (imu_->w().x() - lean_);
    const cnoid::Matrix3 turn = cnoid::AngleAxis(0.3, cnoid::Vector3::UnitZ()).toRotationMatrix();
#if FAULT == 5
    const cnoid::Vector3 rate = turn.transpose() * imu_->w();  // fault 5: the wrong frame
#else
    const cnoid::Vector3 rate = turn * imu_->w();
#endif
    const double phase = phase_at(ticks_ * time_step_);
    for (Leg& leg : legs_) hold(leg, phase, rate.y());
    ++ticks_;
    return true;
  }

 private:
  double phase_at(double time) const {
    double cycles = 2.0 * time;
#if FAULT == 8
    if (time > 0.1) cycles += 0.25;  // fault 8: the phase after a while
#endif
    return cycles - std::floor(cycles);
  }

  double smooth(Leg& leg, double speed) {
#if FAULT == 3
    if (ticks_ > 150) return leg.filtered;  // fault 3: a stale filter
#endif
    leg.filtered += 0.1 * (speed - leg.filtered);
    return leg.filtered;
  }

  double limited(double effort) {
    constexpr double limit = 12.0;
#if FAULT == 9
    if (std::abs(effort) > limit) is_saturated_ = true;  // fault 9: saturation that never ends
#else
    is_saturated_ = std::abs(effort) > limit;
#endif
    return is_saturated_ ? std::clamp(effort, -0.5 * limit, 0.5 * limit) : effort;
  }

  /// Two variables have one name, and fault 11 moves both in the frame: each has a number of its memory at first.
  double halved_twice(double effort) const {
#if FAULT == 11
    const double most = 10.0;
#endif
    if (effort > 0.0) {
      const double part = 0.5 * effort;
      effort = 2.0 * part;
    }
    if (std::abs(effort) > 0.0) {
      const double half = 0.5;
      const double part = half * effort;
      effort = 2.0 * part;
    }
#if FAULT == 11
    effort = std::min(effort, most);  // fault 11: a limit
#endif
    return effort;
  }

  void hold(Leg& leg, double phase, double pitch_rate) {
    const std::array<double, 4> gains{30.0, 35.0, 40.0, 45.0};
#if FAULT == 4
    const double share = (ticks_ / 50) * 0.1;  // fault 4: division of integers
#else
    const double share = (ticks_ / 50.0) * 0.1;
#endif
#if FAULT == 6
    const double swing = std::sin(phase * 360.0);  // fault 6: degrees for radians
#else
    const double swing = std::sin(phase * 2.0 * M_PI);
#endif
#if FAULT == 7
    const bool is_rising = ticks_ <= 100;  // fault 7: the flag of a timer
#else
    const bool is_rising = ticks_ < 100;
#endif
    for (int i = 0; i < 3; ++i) {
      const double wanted = is_rising ? 0.2 * share : 0.1 * swing * leg.side;
#if FAULT == 2
      const double gain = gains[i + 1];  // fault 2: an index off by one
#else
      const double gain = gains[i];
#endif
      const double speed = smooth(leg, leg.joints[i]->dq());
      const double effort = gain * (wanted - leg.joints[i]->q()) - speed - 0.1 * (lean_ + pitch_rate);
      leg.joints[i]->u() = limited(halved_twice(effort));
    }
  }

  /// What follows the array in memory is no joint: pointers to its end lead to nothing.
  std::array<Joint, 2> joints_{{{"hip"}, {"knee"}}};
  std::vector<Leg> legs_;
  std::size_t longest_ = 0;
  cnoid::Imu* imu_ = nullptr;
  double time_step_ = 0.0;
  double lean_;
  int ticks_ = 0;
  bool is_saturated_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Beside)
