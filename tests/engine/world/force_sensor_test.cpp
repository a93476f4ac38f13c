// Force sensors: the wrench of a link on its parent through its joint, in the sensor's frame, about its origin.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double held_mass = 3.0;                             // [kg]
constexpr double arm = 0.4;                                   // of its centre from the joint [m]
constexpr double held_weight = held_mass * standard_gravity;  // [N]
const Inertial rod = inertial(held_mass, {0.01, 0.05, 0.05}, {arm, 0.0, 0.0});

class ForceSensors : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, ForceSensors, each_solver, solver_name);

/// A rod along +x from a hinge about y, on a fixed base; the sensor sits in the rod.
std::shared_ptr<const Model> rod_on_a_hinge(const Eigen::Isometry3d& sensor = Eigen::Isometry3d::Identity()) {
  RobotBuilder robot(JointType::fixed);
  robot.add("ROD", 0, JointType::revolute, Vector3d::UnitY(), rod, at(0, 0, 1));
  robot.add_device("Sensor", 1, ForceSensor{}, sensor);
  return robot.build();
}

/// The rod held level by effort; gravity turns it towards +y with held_weight * arm.
void hold_level(World& world) { run(world, 100, effort(-held_weight * arm)); }

TEST_P(ForceSensors, AHangingMassPullsItsParentDownWithItsWeight) {
  WorldBody body = body_of(rod_on_a_hinge());
  body.joints = {M_PI / 2};  // the rod points down
  const auto world = make_world(settings(), {body});
  run(*world, 100);
  // in the rod's frame, whose x axis points down
  expect_near(device_of(*world, 0).head<3>(), Vector3d(held_weight, 0, 0), 1e-3);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d::Zero(), 1e-3);
}

TEST_P(ForceSensors, ALevelRodBendsItsParentWithItsWeightTimesItsArm) {
  const auto world = make_world(settings(), {body_of(rod_on_a_hinge())});
  hold_level(*world);
  EXPECT_NEAR(joint_of(*world).q, 0.0, 1e-4);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -held_weight), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, held_weight * arm, 0), 1e-2);
}

TEST_P(ForceSensors, TheTorqueIsAboutTheSensorsOrigin) {
  const auto world = make_world(settings(), {body_of(rod_on_a_hinge(at(arm, 0.1, 0)))});
  hold_level(*world);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -held_weight), 1e-2);
  // the held_weight passes 0.1 m beside the sensor: (0, -0.1, 0) x (0, 0, -held_weight)
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0.1 * held_weight, 0, 0), 1e-2);
}

TEST_P(ForceSensors, ReadInTheSensorsFrame) {
  Eigen::Isometry3d pose = at(0, 0, 0);
  pose.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix();  // its y axis is the link's z
  const auto world = make_world(settings(), {body_of(rod_on_a_hinge(pose))});
  hold_level(*world);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, -held_weight, 0), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, 0, -held_weight * arm), 1e-2);
}

TEST_P(ForceSensors, MeasureTheJointsOwnEffortToo) {
  // Weightless, and turned by effort: the joint applies exactly this effort to the rod, and the rod applies the
  // opposite to the parent.
  const auto world = make_world(weightless(GetParam()), {body_of(rod_on_a_hinge())});
  run(*world, 1, effort(2.0));
  EXPECT_NEAR(device_of(*world, 0)[4], -2.0, 1e-6);
}

TEST_P(ForceSensors, AMotorIsMeasuredLikeAnEffort) {
  const auto world = make_world(settings(), {body_of(rod_on_a_hinge())});
  run(*world, 100, displacement(0.0));
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -held_weight), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, held_weight * arm, 0), 1e-2);
  EXPECT_NEAR(joint_of(*world).u, -held_weight * arm, 1e-2);
}

TEST_P(ForceSensors, AFootCarriesWhatStandsOnIt) {
  RobotBuilder robot(JointType::free, inertial(10.0, {0.2, 0.2, 0.2}));
  robot.add("FOOT", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(2.0, {0.02, 0.02, 0.02}), at(0, 0, -0.5));
  robot.add_collision(1, Box{{0.3, 0.3, 0.1}});
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto world = make_world(settings(), {body_of(robot.build(), {0, 0, 0.55}), floor_body()});
  run(*world, 1000, displacement(0.0));
  double mean = 0.0;
  for (int i = 0; i < 1000; ++i) {
    run(*world, 1, displacement(0.0));
    mean += device_of(*world, 0)[2] / 1000;
  }
  EXPECT_NEAR(mean, 10.0 * standard_gravity, 0.5);
}

TEST_P(ForceSensors, OnTheRootMeasureNothing) {
  RobotBuilder robot(JointType::fixed, rod);
  robot.add_device("Sensor", 0, ForceSensor{});
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 10);
  EXPECT_EQ(device_of(*world, 0), Eigen::VectorXd::Zero(6));
}

TEST_P(ForceSensors, ASliderIsMeasuredInAllSixDirections) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(held_mass, {0.1, 0.1, 0.1}, {0.0, 0.2, 0.0}));
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 1, effort(5.0));
  expect_near(device_of(*world, 0).head<3>(), Vector3d(-5.0, 0.0, -held_weight), 1e-2);
  // the held_weight, 0.2 m aside, and the inertia of the centre of mass, which moves on a circle beside the axis
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(-0.2 * held_weight, 0.0, 0.2 * 5.0), 1e-2);
}

TEST_P(ForceSensors, ASliderBetweenTwoFlyingBodiesGivesEachWhatItsMotionTakes) {
  RobotBuilder robot(JointType::free, inertial(4.0, {0.3, 0.3, 0.3}));
  const Vector3d center(0, 0.3, 0);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(2.0, {0.1, 0.1, 0.1}, center),
            at(0.2, 0, 0.1));
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  run(*world, 1, effort(5.0));
  const LinkReading& sled = link_of(*world, 1);
  const Vector3d force = 2.0 * (sled.acceleration + sled.angular_acceleration.cross(center));
  EXPECT_GT(sled.angular_acceleration.norm(), 0.1);
  expect_near(device_of(*world, 0).head<3>(), (-force).eval(), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), (-center.cross(force) - 0.1 * sled.angular_acceleration).eval(), 1e-2);
}

}  // namespace
}  // namespace rehearse
