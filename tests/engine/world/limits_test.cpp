// Limits: applied only if the scenario enables them.

#include <numbers>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Limits : public EachSolver {
 protected:
  WorldSettings still() const { return weightless(GetParam()); }

  /// A wheel whose joint may turn from lower to upper, with an effort of at most 2 N·m.
  static WorldBody wheel(double lower, double upper) {
    RobotBuilder robot(JointType::fixed);
    Joint& joint =
        robot.add("WHEEL", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
    joint.lower = lower;
    joint.upper = upper;
    joint.effort = 2.0;
    return body_of(robot.build());
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Limits, both_solvers, solver_name);

TEST_P(Limits, AreOffByDefault) {
  const auto world = make_world(still(), {wheel(-0.1, 0.1)});
  run(*world, 100, effort(10.0));
  EXPECT_NEAR(joint_of(*world).dq, 10.0 / wheel_inertia * 0.1, 1e-6);
  EXPECT_GT(joint_of(*world).q, 0.1);
}

TEST_P(Limits, OfEffortClampACommand) {
  WorldBody body = wheel(-10.0, 10.0);
  body.effort_limits = true;
  const auto world = make_world(still(), {body});
  run(*world, 100, effort(10.0));
  EXPECT_NEAR(joint_of(*world).dq, 2.0 / wheel_inertia * 0.1, 1e-6);
  EXPECT_EQ(joint_of(*world).u, 2.0);  // the applied effort, not the commanded one
  run(*world, 100, effort(-10.0));
  EXPECT_EQ(joint_of(*world).u, -2.0);
  run(*world, 1, effort(1.5));
  EXPECT_EQ(joint_of(*world).u, 1.5);
}

TEST_P(Limits, OfDisplacementStopTheJointAtBothEnds) {
  WorldBody body = wheel(-0.2, 0.1);
  body.joint_limits = true;
  const auto world = make_world(still(), {body});
  run(*world, 1000, effort(1.0));
  EXPECT_NEAR(joint_of(*world).q, 0.1, 5e-4);
  EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-3);
  run(*world, 1000, effort(-1.0));
  EXPECT_NEAR(joint_of(*world).q, -0.2, 5e-4);
}

TEST_P(Limits, BeyondHalfATurnHoldToo) {
  WorldBody body = wheel(-1.5 * pi, 2.5 * pi);
  body.joint_limits = true;
  const auto world = make_world(still(), {body});
  run(*world, 4000, effort(1.0));
  EXPECT_NEAR(joint_of(*world).q, 2.5 * pi, 1e-3);
  run(*world, 6000, effort(-1.0));
  EXPECT_NEAR(joint_of(*world).q, -1.5 * pi, 1e-3);
}

TEST_P(Limits, StopASliderAndSurviveARestoredState) {
  RobotBuilder robot(JointType::fixed);
  Joint& rail = robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(4.0, {0.1, 0.1, 0.1}));
  rail.lower = -0.05;
  rail.upper = 0.3;
  WorldBody body = body_of(robot.build());
  body.joint_limits = true;
  const auto world = make_world(still(), {body});
  run(*world, 200, effort(20.0));
  const auto state = world->save();
  run(*world, 2000, effort(20.0));
  EXPECT_NEAR(joint_of(*world).q, 0.3, 1e-4);
  const std::uint64_t end = world->state_hash();
  ASSERT_TRUE(world->restore(state).ok());
  run(*world, 2000, effort(20.0));
  EXPECT_EQ(world->state_hash(), end);
}

}  // namespace
}  // namespace rehearse
