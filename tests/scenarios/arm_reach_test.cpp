// An arm that reaches for poses by inverse kinematics.
#include <rehearse/gtest.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using rehearse::Trace;

constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double leg = 1.0;                      // the arm has a second for each target [s]

/// The targets of the scenario; the third is out of reach.
Isometry3d target(int number) {
  const auto pose = [](const Vector3d& position, double pitch, double yaw) {
    Isometry3d made = Isometry3d::Identity();
    made.translation() = position;
    made.linear() = (AngleAxisd(yaw * degree, Vector3d::UnitZ()) * AngleAxisd(pitch * degree, Vector3d::UnitY()))
                        .toRotationMatrix();
    return made;
  };
  if (number == 1) return pose({0.45, 0.15, 0.25}, 180.0, 0.0);
  if (number == 2) return pose({0.35, -0.3, 0.45}, 160.0, -60.0);
  return pose({0.65, 0.1, 0.5}, 120.0, 20.0);
}

/// The tool's position in the simulation [m].
Isometry3d tool(const Trace& trace, double time) {
  const auto number = [&](const std::string& element) { return trace.at("Arm/Reach/input/TOOL/" + element, time); };
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(number("position/x"), number("position/y"), number("position/z"));
  pose.linear() = Eigen::Quaterniond(number("orientation/w"), number("orientation/x"), number("orientation/y"),
                                     number("orientation/z"))
                      .toRotationMatrix();
  return pose;
}

void expect_reached(const Trace& trace, int number, double time) {
  const Isometry3d deviation = target(number).inverse() * tool(trace, time);
  EXPECT_LT(deviation.translation().norm(), 0.001) << "target " << number << " [m]";
  EXPECT_LT(AngleAxisd(deviation.linear()).angle(), 0.1 * degree) << "target " << number;
}

TEST(ArmReach, ReachesItsTargets) {
  const Trace trace = rehearse::record("scenarios/arm_reach.yaml");
  expect_reached(trace, 1, leg);
  expect_reached(trace, 2, 2.0 * leg);
  expect_reached(trace, 4, 4.0 * leg);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(ArmReach, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("ArmReach.ReachesItsTargets"); }

TEST(ArmReach, SaysWhichTargetIsOutOfReachAndStays) {
  const Trace trace = rehearse::record("scenarios/arm_reach.yaml");
  std::vector<std::string> said;
  for (const rehearse::msg::Event& event : trace.events()) said.push_back(event.text);
  ASSERT_EQ(said.size(), 4u);
  EXPECT_EQ(said[0].rfind("target 1 reached within ", 0), 0u) << said[0];
  EXPECT_EQ(said[1].rfind("target 2 reached within ", 0), 0u) << said[1];
  EXPECT_EQ(said[2], "target 3 at 0.9 0 0.3 m is out of reach: the arm stays");
  EXPECT_EQ(said[3].rfind("target 4 reached within ", 0), 0u) << said[3];
  for (double time = 2.0 * leg; time < 3.0 * leg; time += 0.1) expect_reached(trace, 2, time);
}

TEST(ArmReach, BeginsAndEndsEachWayAtRest) {
  const Trace trace = rehearse::record("scenarios/arm_reach.yaml");
  for (const char* joint : {"J1", "J2", "J3", "J4", "J5", "J6"}) {
    const std::string rate = std::string("Arm/") + joint + "/dq";
    for (const double time : {0.0, leg, 2.0 * leg, 3.0 * leg, 4.0 * leg})
      EXPECT_NEAR(trace.at(rate, time), 0.0, 0.01) << joint << " at " << time << " s";  // [rad/s]
    EXPECT_GT(std::max(trace.max(rate), -trace.min(rate)), 0.1) << joint;               // in between it moves
  }
}

TEST(ArmReach, RefusesTargetsThatAreNoSixNumbers) {
  rehearse::BenchOptions options;
  options.options = "\"0.4 0 0.5\"";
  EXPECT_THROW(rehearse::ControllerBench("ArmReachController", "models/six_joint_arm.urdf", options),
               std::runtime_error);
}

}  // namespace
