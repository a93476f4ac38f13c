// A parent controller and its child, which share a robot: one raises an arm, the other keeps its load level.
#include <rehearse/gtest.h>
#include <rehearse/messages.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using rehearse::Trace;

constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double gravity = 9.80665;              // [m/s²]
constexpr double tray = 0.5;                     // [kg]
constexpr double cup = 0.3;                      // [kg]
constexpr double lowest = 30.0 * degree;         // of the shoulder [rad]
constexpr double period = 2.0;                   // for up and down [s]
constexpr double arrival = 2.8;                  // when it has rested as well [s]
constexpr double end = 3.0;                      // [s]

Trace run() { return rehearse::record("scenarios/parent_and_child.yaml"); }

TEST(ParentAndChild, KeepTheCupOnTheTray) {
  const Trace trace = run();
  // in the end the arm is where it began, and so is the cup
  EXPECT_NEAR(trace.last("Cup/Cup/position/x"), trace.first("Cup/Cup/position/x"), 0.005);  // [m]
  EXPECT_NEAR(trace.last("Cup/Cup/position/y"), 0.0, 0.001);
  EXPECT_NEAR(trace.last("Cup/Cup/position/z"), trace.first("Cup/Cup/position/z"), 0.005);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(ParentAndChild, RepeatTheirCommandsWithoutPhysics) { EXPECT_REPLAYS("ParentAndChild.KeepTheCupOnTheTray"); }

TEST(ParentAndChild, RaiseTheArmAndKeepTheTrayLevel) {
  const Trace trace = run();
  EXPECT_NEAR(trace.at("Arm/SHOULDER/q", period / 2.0), -lowest, 2.0 * degree);
  EXPECT_NEAR(trace.at("Arm/SHOULDER/q", end), lowest, 0.5 * degree);
  const std::vector<double> shoulder = trace.values("Arm/SHOULDER/q");
  const std::vector<double> wrist = trace.values("Arm/WRIST/q");
  for (std::size_t i = 0; i < shoulder.size(); ++i) ASSERT_LT(std::abs(shoulder[i] + wrist[i]), 2.0 * degree) << i;
}

TEST(ParentAndChild, WeighTheCup) {
  const Trace trace = run();
  EXPECT_NEAR(trace.mean("Arm/WristForce/force/z", 2.5, end), -(tray + cup) * gravity, 0.02);  // [N], the wrist's frame
  ASSERT_EQ(trace.events().size(), 1u);
  const std::string said = trace.events()[0].text;
  ASSERT_EQ(said.rfind("there are 0.", 0), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(10)), cup, 0.02 * cup) << said;  // [kg]
}

TEST(ParentAndChild, AreCalledOnWhenTheySayThatTheyAreDone) {
  const Trace trace = run();
  for (const char* who : {"controller_results/0", "controller_results/1"}) {
    EXPECT_EQ(trace.at(who, arrival - 0.1), 1.0) << who;
    EXPECT_EQ(trace.at(who, arrival + 0.1), 0.0) << who;
  }
  EXPECT_NEAR(trace.mean("Arm/SHOULDER/dq", 2.5, end), 0.0, 0.01);  // [rad/s]: it is still held
}

TEST(ParentAndChild, DoNotWorkWithoutTheParent) {
  rehearse::BenchOptions options;
  options.options = "{stiffness: 15, damping: 0.8}";
  EXPECT_THROW(rehearse::ControllerBench("ChildController", "models/tray_arm.urdf", options), std::runtime_error);
}

}  // namespace
