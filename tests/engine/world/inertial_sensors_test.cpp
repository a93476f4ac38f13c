// Motion of links, and the readings of gyros, accelerometers and IMUs.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class InertialSensors : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, InertialSensors, each_solver, solver_name);

enum Device { gyro, accelerometer, imu };

/// One free link with one sensor of each kind.
RobotBuilder sensor_box(JointType root = JointType::free, const Eigen::Isometry3d& pose = at(0, 0, 0)) {
  RobotBuilder robot(root, inertial(2.0, {0.02, 0.03, 0.04}));
  robot.add_device("Gyro", 0, Gyro{}, pose);
  robot.add_device("Accelerometer", 0, Accelerometer{}, pose);
  robot.add_device("Imu", 0, Imu{}, pose);
  return robot;
}

TEST_P(InertialSensors, AFreeBodyFallsWithMinusGT) {
  const auto world = make_world(settings(), {body_of(sensor_box().build(), {0, 0, 100})});
  for (int tick = 1; tick <= 1000; ++tick) {
    ASSERT_TRUE(world->step());
    ASSERT_NEAR(link_of(*world).velocity.z(), -standard_gravity * tick * 0.001, 1e-12 * tick);
  }
  // semi-implicit: each step moves with the velocity at its end
  EXPECT_NEAR(link_of(*world).position.z(), 100.0 - standard_gravity * 1e-6 * 1000 * 1001 / 2, 1e-9);
}

TEST_P(InertialSensors, InFreeFallAnAccelerometerReadsZero) {
  const auto world = make_world(settings(), {body_of(sensor_box().build())});
  run(*world, 500);
  expect_near(device_of(*world, accelerometer), Vector3d::Zero(), 1e-9);
  expect_near(link_of(*world).acceleration, Vector3d(0, 0, -standard_gravity), 1e-9);
}

TEST_P(InertialSensors, ALinkThatIsFixedReadsPlusGExactly) {
  const auto world = make_world(settings(), {body_of(sensor_box(JointType::fixed).build())});
  run(*world, 2);
  EXPECT_EQ(device_of(*world, accelerometer), Vector3d(0, 0, standard_gravity));
  EXPECT_EQ(device_of(*world, gyro), Vector3d::Zero());
}

TEST_P(InertialSensors, ABoxAtRestOnAFloorReadsPlusG) {
  RobotBuilder robot = sensor_box();
  robot.add_collision(0, Box{{0.2, 0.2, 0.2}});
  const auto world = make_world(settings(), {body_of(robot.build(), {0, 0, 0.1}), floor_body()});
  run(*world, 2000);
  expect_near(device_of(*world, accelerometer), Vector3d(0, 0, standard_gravity), 1e-3);
  expect_near(device_of(*world, imu).tail<3>(), Vector3d(0, 0, standard_gravity), 1e-3);
  EXPECT_NEAR(link_of(*world).position.z(), 0.1, 1e-3);
}

TEST_P(InertialSensors, ReadInTheirOwnFrame) {
  Eigen::Isometry3d pose = at(0, 0, 0);
  pose.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix();  // its y axis is the link's z
  const auto world = make_world(settings(), {body_of(sensor_box(JointType::fixed, pose).build())});
  run(*world, 1);
  expect_near(device_of(*world, accelerometer), Vector3d(0, standard_gravity, 0), 1e-12);
}

TEST_P(InertialSensors, AGyroTurnsWithItsLink) {
  WorldSettings still = settings();
  still.gravity.setZero();
  WorldBody body = body_of(sensor_box().build());
  body.rotation = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY());  // the link's z axis is the world's x
  const auto world = make_world(still, {body});
  world->push(0, 0, Vector3d::Zero(), Vector3d::Zero(), {0.04, 0.0, 0.0});  // 1 rad/s² about the link's z
  run(*world, 1);
  expect_near(device_of(*world, gyro), Vector3d(0, 0, 0.001), 1e-12);
  expect_near(device_of(*world, imu).head<3>(), Vector3d(0, 0, 0.001), 1e-12);
  expect_near(link_of(*world).angular_acceleration, Vector3d(1, 0, 0), 1e-9);
}

/// A link on a hinge about z, with an accelerometer and an Imu 0.5 m off its origin; the axes of the Imu are turned by
/// a quarter about z.
RobotBuilder turning_arm() {
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add_device("Accelerometer", 1, Accelerometer{}, at(0.5, 0, 0));
  Eigen::Isometry3d turned = at(0.5, 0, 0);
  turned.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  robot.add_device("Imu", 1, Imu{}, turned);
  return robot;
}

TEST_P(InertialSensors, OffTheirLinksOriginReadTheCentripetalAcceleration) {
  WorldBody body = body_of(turning_arm().build());
  body.joint_velocities = {2.0};
  const auto world = make_world(weightless(GetParam()), {body});
  run(*world, 100);
  // w² r = 2² x 0.5 towards the axis
  expect_near(device_of(*world, 0), Vector3d(-2, 0, 0), 1e-9);
  expect_near(device_of(*world, 1).tail<3>(), Vector3d(0, 2, 0), 1e-9);
  expect_near(device_of(*world, 1).head<3>(), Vector3d(0, 0, 2), 1e-9);
}

TEST_P(InertialSensors, OffTheirLinksOriginReadTheTangentialAcceleration) {
  const auto world = make_world(weightless(GetParam()), {body_of(turning_arm().build())});
  world->push(0, 1, Vector3d::Zero(), Vector3d::Zero(), {0.0, 0.0, 0.3});  // 3 rad/s²
  run(*world, 1);  // the push acts while the arm is still at rest
  expect_near(device_of(*world, 0), Vector3d(0, 3.0 * 0.5, 0), 1e-9);
}

/// A link that spins without a load: at its centre, 0.5 m off the hinge, it is accelerated towards the hinge only.
TEST_P(InertialSensors, OfASpinningLinkReadNoTangentialAcceleration) {
  RobotBuilder robot(JointType::fixed);
  robot.add("LINK", 0, JointType::continuous, Vector3d::UnitZ(), inertial(1.0, Vector3d::Constant(1e-3), {0.5, 0, 0}));
  robot.add_device("Imu", 1, Imu{}, at(0.5, 0, 0));
  robot.add_device("Force", 1, ForceSensor{});
  WorldBody body = body_of(robot.build());
  body.joint_velocities = {20.0};  // [rad/s]
  const auto world = make_world(weightless(GetParam()), {body});
  run(*world, 100);
  const double w = link_of(*world, 1).angular_velocity.z();
  const auto acceleration = device_of(*world, 0).tail<3>();
  EXPECT_NEAR(acceleration.x(), -w * w * 0.5, 3.0);  // the direction turns by 0.02 rad in a step
  EXPECT_NEAR(acceleration.y(), 0.0, 0.02);
  EXPECT_NEAR(device_of(*world, 1)[1], 0.0, 0.02);  // force across the link [N]
  EXPECT_NEAR(device_of(*world, 1)[5], 0.0, 1e-9);  // torque about the free hinge [N·m]
}

TEST_P(InertialSensors, ReadTheirLinksOriginWithoutLeverArms) {
  WorldSettings as_in_choreonoid = weightless(GetParam());
  as_in_choreonoid.lever_arms = false;
  WorldBody body = body_of(turning_arm().build());
  body.joint_velocities = {2.0};
  const auto world = make_world(as_in_choreonoid, {body});
  run(*world, 100);
  expect_near(device_of(*world, 0), Vector3d::Zero(), 1e-9);
}

TEST_P(InertialSensors, OfAKinematicBodyReadTheLeverArm) {
  WorldBody body = body_of(turning_arm().build());
  body.kinematic = true;
  const auto world = make_world(weightless(GetParam()), {body});
  run(*world, 100, velocity(2.0));
  expect_near(device_of(*world, 0), Vector3d(-2, 0, 0), 1e-5);
}

TEST_P(InertialSensors, AllReadZeroBeforeTheFirstStepAndAreNotFresh) {
  const auto world = make_world(settings(), {body_of(sensor_box(JointType::fixed).build())});
  for (const DeviceReading& device : world->sense().bodies[0].devices) {
    EXPECT_FALSE(device.fresh);
    for (const double value : device.values) EXPECT_EQ(value, 0.0);
  }
  run(*world, 1);
  for (const DeviceReading& device : world->sense().bodies[0].devices) {
    EXPECT_TRUE(device.fresh);
    EXPECT_EQ(device.measured_at, world->time());
  }
}

}  // namespace
}  // namespace rehearse
