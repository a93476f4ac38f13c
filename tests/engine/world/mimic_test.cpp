// A joint that mimics a leader follows it, whatever forces act on it.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Mimics : public EachSolver {
 protected:
  /// A gripper: two fingers on rails along x; the second moves in the opposite direction at half the speed, with an
  /// offset of 0.1 m.
  static WorldBody gripper() {
    RobotBuilder robot(JointType::fixed);
    robot.add("LEFT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
    Joint& right =
        robot.add("RIGHT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 1, 0));
    right.mimic = Mimic{0, -0.5, 0.1};
    WorldBody body = body_of(robot.build());
    body.joints = {0.0, 0.1};
    return body;
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Mimics, each_solver, solver_name);

TEST_P(Mimics, FollowTheLeadersDisplacementAndSpeed) {
  const auto world = make_world(weightless(GetParam()), {gripper()});
  for (int tick = 0; tick < 500; ++tick) {
    run(*world, 1, effort(3.0));
    ASSERT_NEAR(joint_of(*world, 1).q, 0.1 - 0.5 * joint_of(*world, 0).q, 3e-6) << tick;  // ddq dt² behind
  }
  EXPECT_GT(joint_of(*world, 0).q, 0.3);
  EXPECT_NEAR(joint_of(*world, 1).dq, -0.5 * joint_of(*world, 0).dq, 2e-3);
}

TEST_P(Mimics, HoldAgainstAForce) {
  const auto world = make_world(weightless(GetParam()), {gripper()});
  for (int tick = 0; tick < 100; ++tick) {
    world->push(0, 2, {50.0, 0.0, 0.0}, Vector3d::Zero(), Vector3d::Zero());
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(joint_of(*world, 1).q, 0.1, 1e-6);
  EXPECT_NEAR(joint_of(*world, 1).u, -50.0, 1e-3);  // the effort needed to follow
}

TEST_P(Mimics, DontListenToCommandsOfTheirOwn) {
  const auto world = make_world(weightless(GetParam()), {gripper()});
  run(*world, 100, displacement(0.9), 1);
  EXPECT_NEAR(joint_of(*world, 1).q, 0.1, 1e-6);
}

TEST_P(Mimics, AreNoStrongerThanTheirEffortLimit) {
  RobotBuilder robot(JointType::fixed);
  robot.add("LEFT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  Joint& right = robot.add("RIGHT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  right.mimic = Mimic{0, 1.0, 0.0};
  right.effort = 10.0;
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  for (int tick = 0; tick < 100; ++tick) {
    world->push(0, 2, {50.0, 0.0, 0.0}, Vector3d::Zero(), Vector3d::Zero());
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(joint_of(*world, 1).dq, (50.0 - 10.0) * 0.1, 1e-3);
}

}  // namespace
}  // namespace rehearse
