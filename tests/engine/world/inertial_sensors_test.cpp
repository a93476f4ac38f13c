// Motion of links, and the readings of gyros, accelerometers and IMUs.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class InertialSensors : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, InertialSensors, both_solvers, solver_name);

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

TEST_P(InertialSensors, TheLeverArmOfASensorInItsLinkIsIgnored) {
  WorldSettings still = settings();
  still.gravity.setZero();
  const auto world = make_world(still, {body_of(sensor_box(JointType::free, at(1, 0, 0)).build())});
  world->push(0, 0, Vector3d::Zero(), Vector3d::Zero(), {0.0, 0.0, 0.04});
  run(*world, 1);
  expect_near(device_of(*world, accelerometer), Vector3d::Zero(), 1e-12);
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
