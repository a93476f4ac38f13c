// A controller of the quadruped with thirteen more faults to choose from, each a change of one line: FAULT is the
// number of one, or 0. The comment "fault N" marks the line that --beside is to name.
#include <cnoid/Imu>
#include <cnoid/SimpleController>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#ifndef FAULT
#define FAULT 0
#endif

namespace {

enum class Phase { rise, hold, sway };

class BesideMore : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (cnoid::Link* joint : io->body()->joints()) {
      joint->setActuationMode(cnoid::Link::JointEffort);
      io->enableInput(joint, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
      io->enableOutput(joint);
      joints_.push_back(joint);
    }
    time_step_ = io->timeStep();
    return true;
  }

  bool control() override {
    choose_phase();
    integrate();
    const double load = load_of_legs();
    const auto damped = [this](double effort, const cnoid::Link* joint) {
#if FAULT == 23
      return effort + damping_ * joint->dq();  // fault 23: a sign in a lambda
#else
      return effort - damping_ * joint->dq();
#endif
    };
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const double wanted = target_of(i);
      const double effort = gain() * (wanted - joints_[i]->q()) + 0.01 * integral_ + 0.001 * load;
      joints_[i]->u() = std::clamp(damped(effort, joints_[i]), -20.0, 20.0);
    }
    ++ticks_;
    return true;
  }

 private:
  int limit_of(Phase phase) const {
    const int limits[] = {50, 120, 400};
    return limits[static_cast<int>(phase)];
  }

  void choose_phase() {
#if FAULT == 12
    if (ticks_ >= limit_of(phase_)) next_phase();  // fault 12: >= for >
#else
    if (ticks_ > limit_of(phase_)) next_phase();
#endif
  }

  void next_phase() {
    phase_ = phase_ == Phase::rise ? Phase::hold : Phase::sway;
#if FAULT == 21
    filtered_ = 0.0;  // fault 21: another variable is reset
#else
    integral_ = 0.0;
#endif
  }

  bool is_near(double error) const {
#if FAULT == 24
    return std::abs(error) > near_;  // fault 24: > for <, in a function that returns a bool
#else
    return std::abs(error) < near_;
#endif
  }

  void integrate() {
    const double error = 0.3 - joints_[1]->q();
#if FAULT == 13
    integral_ = error * time_step_;  // fault 13: = for +=
#else
    integral_ += error * time_step_;
#endif
#if FAULT == 17
    if (is_near(error) || ticks_ > 200) filtered_ += 0.1 * (error - filtered_);  // fault 17: || for &&
#else
    if (is_near(error) && ticks_ > 200) filtered_ += 0.1 * (error - filtered_);
#endif
  }

  double load_of_legs() const {
    double load = 0.0;
    for (int leg = 0; leg < 4; ++leg)
#if FAULT == 16
      for (int joint = 0; joint < 2; ++joint)  // fault 16: a joint too few
#else
      for (int joint = 0; joint < 3; ++joint)
#endif
        load += std::abs(joints_[static_cast<std::size_t>(3 * leg + joint)]->q());
    std::array<double, 4> knees{};
    for (std::size_t leg = 0; leg < 4; ++leg) knees[leg] = joints_[3 * leg + 2]->q();
#if FAULT == 22
    const double knee = *std::min_element(knees.begin(), knees.end());  // fault 22: the smallest for the largest
#else
    const double knee = *std::max_element(knees.begin(), knees.end());
#endif
    return load + knee;
  }

  static double mixed(double from, double to, double share) { return from + share * (to - from); }

  double target_of(std::size_t joint) const {
    const double share = std::min(1.0, ticks_ / 100.0);
    double target = 0.0;
    switch (phase_) {
      case Phase::rise:
#if FAULT == 14
        target = mixed(0.4, 0.1, share);  // fault 14: exchanged arguments
#else
        target = mixed(0.1, 0.4, share);
#endif
        break;
      case Phase::hold: target = 0.4 + filtered_;  // fault 15: no break follows
#if FAULT == 15
        [[fallthrough]];
#else
        break;
#endif
      case Phase::sway: target = 0.4 + 0.1 * std::sin(0.01 * ticks_); break;
    }
    return joint % 3 == 0 ? swayed(target) : target;
  }

  double swayed(double target) const {
#if FAULT == 18
    if (phase_ != Phase::hold) return 0.5 * target;  // fault 18: != for ==
#else
    if (phase_ == Phase::hold) return 0.5 * target;
#endif
#if FAULT == 19
    return ticks_ > 30 ? target : 0.1 * target;  // fault 19: exchanged results
#else
    return ticks_ > 30 ? 0.1 * target : target;
#endif
  }

  double gain() const {
#if FAULT == 20
    constexpr double gains[] = {30.0, 54.0, 40.0};  // fault 20: exchanged digits
#else
    constexpr double gains[] = {30.0, 45.0, 40.0};
#endif
    return gains[static_cast<int>(phase_)];
  }

  std::vector<cnoid::Link*> joints_;
  double time_step_ = 0.0;
  double damping_ = 0.8, near_ = 5.0;
  Phase phase_ = Phase::rise;
  double integral_ = 0.0, filtered_ = 0.0;
  int ticks_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(BesideMore)
