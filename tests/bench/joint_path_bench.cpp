// The cost of inverse kinematics relative to forward kinematics of the same arm.

#include <cnoid/JointPath>

#include <array>
#include <cmath>

#include "../controllers/bodies.h"
#include "pairs.h"

namespace rehearse {
namespace {

constexpr int goals = 64;
constexpr int rounds = 4;  // of all goals, measured at a time

/// The arm, and poses that it can reach from one posture: each joint within 0.4 rad of its start.
class ArmAndGoals {
 public:
  ArmAndGoals() {
    for (std::size_t i = 0; i < goals; ++i) {
      for (int j = 0; j < 6; ++j) body_->joint(j)->q() = start_q[j] + 0.4 * std::sin(1.0 + 7.0 * i + 2.0 * j);
      path_->calcForwardKinematics();
      goals_[i] = path_->endLink()->T();
    }
    go_to_start();
  }

  /// All goals, each from the start. How many were reached.
  int solve_all() {
    int solved = 0;
    for (const cnoid::Isometry3& goal : goals_) {
      go_to_start();
      solved += path_->calcInverseKinematics(goal);
      steps_ += path_->numIterations();
    }
    return solved;
  }
  void move_all() {
    for (int i = 0; i < goals; ++i) go_to_start();
  }
  double steps() const { return steps_; }

 private:
  static constexpr double start_q[6] = {0.1, 0.4, 0.9, -0.2, 0.6, 0.1};  // [rad]

  void go_to_start() {
    for (int j = 0; j < 6; ++j) path_->joint(j)->q() = start_q[j];
    path_->calcForwardKinematics();
  }

  cnoid::BodyPtr body_ = test::make_six_joint_arm();
  std::shared_ptr<cnoid::JointPath> path_ = cnoid::JointPath::getCustomPath(body_->rootLink(), body_->link("L6"));
  std::array<cnoid::Isometry3, goals> goals_;
  double steps_ = 0.0;
};

/// Work: JointPath::calcInverseKinematics() after the forward kinematics that it starts from. Base: that alone.
void inverse_over_forward_kinematics(benchmark::State& state) {
  ArmAndGoals arm;
  Pairs pairs;
  double solved = 0.0;
  double asked = 0.0;
  for (auto _ : Repeated(state)) {
    const auto solve = [&] {
      for (int i = 0; i < rounds; ++i) solved += arm.solve_all();
    };
    const auto move = [&] {
      for (int i = 0; i < rounds; ++i) arm.move_all();
    };
    state.SetIterationTime(pairs.measure(solve, move));
    asked += goals * rounds;
  }
  if (solved != asked) state.SkipWithError("a goal was not reached");
  pairs.report(state, goals * rounds, goals * rounds);
  state.counters["steps"] = arm.steps() / asked;
}
BENCHMARK(inverse_over_forward_kinematics)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
