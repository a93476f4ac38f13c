// SR1, a humanoid of 29 joints, under its minimum controller: a proportional-derivative law that holds a posture.
#include <rehearse/gtest.h>
#include <rehearse/urdf.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using Eigen::Vector3d;
using rehearse::ControllerBench;
using rehearse::Trace;

constexpr double gravity = 9.80665;  // [m/s²]
constexpr double settled = 5.0;      // when SR1 has come to rest [s]
constexpr double end = 10.0;         // [s]

/// Recorded once, looked at by several tests.
const Trace& standing() {
  static const Trace trace = rehearse::record("scenarios/sr1_standing.yaml");
  return trace;
}

const rehearse::Model& sr1() {
  static const auto model = rehearse::load_urdf(rehearse::fixture_path("models/sr1.urdf"));
  return model.value();
}

/// Mean while it stands.
double mean(const std::string& series) { return standing().mean("SR1/" + series, settled, end); }
Vector3d mean_vector(const std::string& series) {
  return {mean(series + "/x"), mean(series + "/y"), mean(series + "/z")};
}

const rehearse::Link& foot(const std::string& side) { return sr1().links[sr1().find_link(side + "LEG_ANKLE_R")]; }

/// Where the floor's forces act on a foot, relative to the ankle, from what the ankle's sensor measures about its
/// origin. The foot is at rest: sensor, floor and weight are in balance. p x F = torque + c x weight, with p at the
/// sole's height.
struct FloorForce {
  Vector3d force;   // on the foot [N]
  Vector3d center;  // of pressure, from the ankle's origin [m]
};
FloorForce floor_force(const std::string& sensor, const rehearse::Link& link) {
  constexpr double sole = -0.055;  // [m] below the ankle
  const Vector3d weight(0.0, 0.0, -link.inertial.mass * gravity);
  const Vector3d force = mean_vector(sensor + "/force") - weight;
  const Vector3d torque = mean_vector(sensor + "/torque") - link.inertial.center.cross(weight);
  return {force, {(sole * force.x() - torque.y()) / force.z(), (torque.x() + sole * force.y()) / force.z(), sole}};
}

/// Centre of mass of the whole robot in the posture in which it stands.
struct Posture {
  Vector3d center_of_mass = Vector3d::Zero();
  std::vector<Eigen::Isometry3d> links;
};
Posture posture() {
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  const std::string w = "WAIST/orientation/";
  root.linear() =
      Eigen::Quaterniond(mean(w + "w"), mean(w + "x"), mean(w + "y"), mean(w + "z")).normalized().toRotationMatrix();
  root.translation() = mean_vector("WAIST/position");
  std::vector<double> q;
  for (const int link : sr1().joints) q.push_back(mean(sr1().links[link].joint.name + "/q"));
  Posture stands;
  stands.links = forward_kinematics(sr1(), root, q);
  for (std::size_t i = 0; i < sr1().links.size(); ++i) {
    const rehearse::Inertial& inertial = sr1().links[i].inertial;
    stands.center_of_mass += inertial.mass / sr1().mass() * (stands.links[i] * inertial.center);
  }
  return stands;
}

TEST(SR1, StandsUnderItsMinimumController) {
  const Trace trace = rehearse::record("scenarios/sr1_minimum.yaml");
  EXPECT_NEAR(trace.last("SR1/WAIST/position/z"), 0.7135, 0.01);  // [m]
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(SR1, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("SR1.StandsUnderItsMinimumController"); }

TEST(SR1, KeepsItsHeightOnceItHasTakenItsWeight) {
  const double height = mean("WAIST/position/z");
  EXPECT_NEAR(height, 0.7135, 0.01);  // [m]: the knees give way a little when they first bear the weight
  const std::vector<double> times = standing().times("SR1/WAIST/position/z");
  const std::vector<double> heights = standing().values("SR1/WAIST/position/z");
  ASSERT_EQ(heights.size(), 10001u);
  for (std::size_t i = 500; i < heights.size(); ++i)
    ASSERT_NEAR(heights[i], height, 0.005) << "at " << times[i] << " s";
}

TEST(SR1, StandsOnItsAnklesWithTheWeightOfAllAboveThem) {
  const double carried = sr1().mass() - foot("L").inertial.mass - foot("R").inertial.mass;
  const double measured = mean("LeftAnkleForceSensor/force/z") + mean("RightAnkleForceSensor/force/z");
  EXPECT_NEAR(measured, carried * gravity, 0.01 * carried * gravity);
}

TEST(SR1, PressesOnTheFloorInsideTheSolesOfItsFeet) {
  for (const std::string side : {"L", "R"}) {
    const FloorForce floor = floor_force(side == "L" ? "LeftAnkleForceSensor" : "RightAnkleForceSensor", foot(side));
    EXPECT_GT(floor.force.z(), 0.0);
    EXPECT_GT(floor.center.x(), 0.055 - 0.125);  // a sole is 0.25 m x 0.14 m, its middle 0.055 m before the ankle
    EXPECT_LT(floor.center.x(), 0.055 + 0.125);
    EXPECT_GT(floor.center.y(), -0.07);
    EXPECT_LT(floor.center.y(), 0.07);
  }
}

TEST(SR1, PressesOnTheFloorRightBelowItsCenterOfMass) {
  const Posture stands = posture();
  Vector3d moment = Vector3d::Zero();
  double force = 0.0;
  for (const std::string side : {"L", "R"}) {
    const FloorForce floor = floor_force(side == "L" ? "LeftAnkleForceSensor" : "RightAnkleForceSensor", foot(side));
    const Vector3d ankle = stands.links[sr1().find_link(side + "LEG_ANKLE_R")].translation();
    moment += floor.force.z() * (ankle + floor.center);
    force += floor.force.z();
  }
  EXPECT_NEAR(moment.x() / force, stands.center_of_mass.x(), 0.002);  // [m]
  EXPECT_NEAR(moment.y() / force, stands.center_of_mass.y(), 0.002);
}

TEST(SR1, FeelsGravityUpwardsAtRest) {
  EXPECT_NEAR(mean("WaistAccelSensor/linear_acceleration/z"), gravity, 0.01 * gravity);
  EXPECT_NEAR(mean("WaistAccelSensor/linear_acceleration/x"), 0.0, 0.01 * gravity);
  EXPECT_NEAR(mean("WaistAccelSensor/linear_acceleration/y"), 0.0, 0.01 * gravity);
  EXPECT_NEAR(mean("WaistIMU/linear_acceleration/z"), gravity, 0.01 * gravity);
}

TEST(SR1, FeelsNothingInFreeFall) {
  const Trace trace = rehearse::record("scenarios/sr1_falling.yaml");
  EXPECT_NEAR(trace.last("SR1/WAIST/position/z"), 10.0 - 0.5 * gravity * 0.25, 0.01);  // [m], after half a second
  for (const char* axis : {"x", "y", "z"}) {
    const std::string series = std::string("SR1/WaistAccelSensor/linear_acceleration/") + axis;
    for (const double value : trace.values(series)) EXPECT_LT(std::abs(value), 1e-6) << series;
  }
}

TEST(SR1Minimum, HoldsAKneeByItsGains) {
  ControllerBench bench("SR1MinimumController", "models/sr1.urdf");
  bench.joint("RLEG_KNEE").q = 0.01;  // [rad], where 0 is wanted, and reached within one step of 1 ms
  bench.tick();
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, -8000.0 * 0.01 - 100.0 * 0.01 / 0.001, 1e-9);  // [N·m]
  EXPECT_EQ(bench.joint("LLEG_KNEE").u, 0.0);
  bench.tick();  // the joint hasn't moved since: its speed is zero
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, -8000.0 * 0.01, 1e-9);
}

TEST(SR1Minimum, IsSofterInItsArms) {
  ControllerBench bench("SR1MinimumController", "models/sr1.urdf");
  bench.joint("RARM_ELBOW").q = -0.01;
  bench.tick();
  bench.tick();
  EXPECT_NEAR(bench.joint("RARM_ELBOW").u, 3000.0 * 0.01, 1e-9);  // [N·m]
}

TEST(SR1Minimum, HoldsThePostureInWhichItBegins) {
  rehearse::BenchOptions options;
  options.joints = {{"RLEG_KNEE", 0.3}};  // [rad]
  ControllerBench bench("SR1MinimumController", "models/sr1.urdf", options);
  bench.tick();
  EXPECT_EQ(bench.joint("RLEG_KNEE").u, 0.0);
}

}  // namespace
