// Links behind floating joints: bodies of their own.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class FloatingJoints : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, FloatingJoints, each_solver, solver_name);

/// A base that is fixed to the world, and a block behind a floating joint, 2 m above it, with a hinged lid.
RobotBuilder base_and_block() {
  RobotBuilder robot(JointType::fixed, inertial(1.0, {1, 1, 1}));
  robot.add("BLOCK", 0, JointType::free, Vector3d::UnitX(), inertial(2.0, {0.02, 0.03, 0.04}), at(0, 0, 2));
  robot.add("LID", 1, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.01, 0.01, 0.01}), at(0.5, 0, 0));
  return robot;
}

TEST_P(FloatingJoints, LeaveTheLinkFree) {
  const auto world = make_world(settings(), {body_of(base_and_block().build())});
  EXPECT_EQ(link_of(*world, 1).position, Vector3d(0, 0, 2));
  run(*world, 500);
  EXPECT_EQ(link_of(*world, 0).position, Vector3d::Zero());
  // semi-implicit: each step moves with the velocity at its end
  const double height = 2.0 - standard_gravity * 1e-6 * 500 * 501 / 2;
  expect_near(link_of(*world, 1).position, Vector3d(0, 0, height), 1e-9);
  expect_near(link_of(*world, 2).position, Vector3d(0.5, 0, height), 1e-9);
}

TEST_P(FloatingJoints, LetItTouchItsOwnBody) {
  RobotBuilder robot = base_and_block();
  robot.add_collision(0, Box{{1, 1, 1}});
  robot.add_collision(1, Box{{1, 1, 1}});
  WorldBody body = body_of(robot.build());
  body.self_collision = true;
  const auto world = make_world(settings(), {body});
  run(*world, 2000);
  EXPECT_NEAR(link_of(*world, 1).position.z(), 1.0, 1e-3);
}

/// A box that begins a micrometre deep in the base lies on it; a link that a joint connects to the box would not.
TEST_P(FloatingJoints, LetItLieOnItsOwnBodyFromTheStart) {
  RobotBuilder robot(JointType::fixed, inertial(1.0, {1, 1, 1}));
  robot.add("BLOCK", 0, JointType::free, Vector3d::UnitX(), inertial(2.0, {0.02, 0.03, 0.04}), at(0, 0, 1.0 - 1e-6));
  robot.add_collision(0, Box{{1, 1, 1}});
  robot.add_collision(1, Box{{1, 1, 1}});
  WorldBody body = body_of(robot.build());
  body.self_collision = true;
  const auto world = make_world(settings(), {body});
  EXPECT_TRUE(world->remarks().empty());
  run(*world, 1000);
  EXPECT_NEAR(link_of(*world, 1).position.z(), 1.0, 1e-3);
}

TEST_P(FloatingJoints, CarryNoForce) {
  RobotBuilder robot = base_and_block();
  robot.add_device("Force", 1, ForceSensor{});
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 10);
  EXPECT_TRUE(device_of(*world, 0).isZero(0.0));
}

}  // namespace
}  // namespace rehearse
