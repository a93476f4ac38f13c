// Hinges and sliders: signs, angles beyond a turn, and the effects of effort.

#include <numbers>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Joints : public EachSolver {
 protected:
  WorldSettings still() const { return weightless(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Solver, Joints, each_solver, solver_name);

/// A wheel of 0.5 kg·m² about `axis`, on a base that is fixed to the world.
std::shared_ptr<const Model> wheel(const Vector3d& axis = Vector3d::UnitY()) {
  RobotBuilder robot(JointType::fixed);
  robot.add("WHEEL", 0, JointType::continuous, axis, inertial(1.0, {0.5, 0.5, 0.5}), at(0, 0, 1));
  return robot.build();
}

std::shared_ptr<const Model> sled(const Vector3d& axis = Vector3d::UnitX()) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, axis, inertial(4.0, {0.1, 0.1, 0.1}), at(0, 0, 1));
  return robot.build();
}

TEST_P(Joints, APositiveRateAboutTheAxisGivesAPositiveAngle) {
  const auto world = make_world(still(), {body_of(wheel())});
  run(*world, 100, velocity(2.0));
  EXPECT_NEAR(joint_of(*world).q, 0.2, 1e-6);
  EXPECT_NEAR(joint_of(*world).dq, 2.0, 1e-6);
  expect_near(link_of(*world, 1).angular_velocity, Vector3d(0, 2, 0), 1e-6);
  // a turn of 0.2 about +y takes the link's x axis towards -z
  expect_near(link_of(*world, 1).rotation * Vector3d::UnitX(), Vector3d(std::cos(0.2), 0, -std::sin(0.2)), 1e-6);
}

TEST_P(Joints, AnAngleIsUnwrappedOverSeveralTurnsBothWays) {
  const auto world = make_world(still(), {body_of(wheel())});
  double before = 0.0;
  for (int i = 0; i < 250; ++i) {
    run(*world, 10, velocity(10.0));
    ASSERT_NEAR(joint_of(*world).q - before, 0.1, 1e-4);
    before = joint_of(*world).q;
  }
  EXPECT_NEAR(joint_of(*world).q, 25.0, 1e-3);  // four turns
  run(*world, 5000, velocity(-10.0));
  EXPECT_NEAR(joint_of(*world).q, -25.0, 1e-3);
}

TEST_P(Joints, AnAngleBeyondATurnIsKeptFromTheStart) {
  for (const double start : {7.0, -7.0, 20.0, pi + 0.01, -pi - 0.01}) {
    WorldBody body = body_of(wheel());
    body.joints = {start};
    const auto world = make_world(still(), {body});
    EXPECT_NEAR(joint_of(*world).q, start, 1e-12);
    run(*world, 100, velocity(1.0));
    EXPECT_NEAR(joint_of(*world).q, start + 0.1, 1e-6);
  }
}

TEST_P(Joints, EffortTurnsAHingeWithTauOverI) {
  const auto world = make_world(still(), {body_of(wheel())});
  run(*world, 1, effort(3.0));
  EXPECT_NEAR(joint_of(*world).ddq, 6.0, 1e-6);
  EXPECT_NEAR(joint_of(*world).dq, 0.006, 1e-9);
  EXPECT_EQ(joint_of(*world).u, 3.0);
  expect_near(link_of(*world, 1).angular_acceleration, Vector3d(0, 6, 0), 1e-6);
  run(*world, 99, effort(3.0));
  EXPECT_NEAR(joint_of(*world).dq, 0.6, 1e-6);
}

TEST_P(Joints, EffortPushesASliderWithFOverM) {
  const auto world = make_world(still(), {body_of(sled())});
  run(*world, 1, effort(8.0));
  EXPECT_NEAR(joint_of(*world).ddq, 2.0, 1e-6);
  expect_near(link_of(*world, 1).acceleration, Vector3d(2, 0, 0), 1e-6);
  run(*world, 999, effort(8.0));
  EXPECT_NEAR(joint_of(*world).dq, 2.0, 1e-6);
  EXPECT_NEAR(joint_of(*world).q, 2.0 * 1e-6 * 1000 * 1001 / 2, 1e-6);
  EXPECT_NEAR(link_of(*world, 1).position.x(), joint_of(*world).q, 1e-6);
  EXPECT_NEAR(link_of(*world, 1).position.z(), 1.0, 1e-6);
}

TEST_P(Joints, EffortActsAlongAnAxisThatIsTurned) {
  const Vector3d axis = Vector3d(1, 2, 2) / 3.0;
  const auto world = make_world(still(), {body_of(wheel(axis)), [&] {
                                            WorldBody body = body_of(sled(axis));
                                            body.name = "Sled";
                                            return body;
                                          }()});
  Command command = idle(*world);
  command.bodies[0].joints[0] = effort(0.5);
  command.bodies[1].joints[0] = effort(4.0);
  world->actuate(command);
  ASSERT_TRUE(world->step());
  expect_near(link_of(*world, 1, 0).angular_acceleration, axis, 1e-6);
  expect_near(link_of(*world, 1, 1).acceleration, axis, 1e-6);
}

TEST_P(Joints, EffortOnAFreeBodyTurnsBothSidesApart) {
  RobotBuilder robot(JointType::free, inertial(1.0, {1.0, 1.0, 1.0}));
  robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitZ(), inertial(1.0, {0.5, 0.5, 0.5}));
  const auto world = make_world(still(), {body_of(robot.build())});
  run(*world, 1, effort(1.0));
  EXPECT_NEAR(link_of(*world, 1).angular_acceleration.z(), 2.0, 1e-6);
  EXPECT_NEAR(link_of(*world, 0).angular_acceleration.z(), -1.0, 1e-6);
  EXPECT_NEAR(joint_of(*world).ddq, 3.0, 1e-6);
}

TEST_P(Joints, InitialDisplacementsPoseTheLinks) {
  RobotBuilder robot(JointType::fixed);
  robot.add("UPPER", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, 1));
  robot.add("LOWER", 1, JointType::prismatic, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, -0.5));
  WorldBody body = body_of(robot.build(), {1, 2, 3});
  body.joints = {pi / 2, -0.25};
  const auto world = make_world(still(), {body});
  EXPECT_NEAR(joint_of(*world, 0).q, pi / 2, 1e-12);
  EXPECT_NEAR(joint_of(*world, 1).q, -0.25, 1e-12);
  expect_near(link_of(*world, 2).position, Vector3d(1 - 0.75, 2, 4), 1e-12);
}

TEST_P(Joints, AJointThatNobodyDrivesIsFree) {
  const auto world = make_world(settings(), {body_of(sled(Vector3d::UnitZ()))});
  run(*world, 100);
  EXPECT_NEAR(joint_of(*world).dq, -standard_gravity * 0.1, 1e-6);
  EXPECT_EQ(joint_of(*world).u, 0.0);
}

}  // namespace
}  // namespace rehearse
