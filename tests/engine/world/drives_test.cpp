// Drives: velocity, displacement, and a joint's dry friction.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Drives : public EachSolver {
 protected:
  WorldSettings still() const { return weightless(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Solver, Drives, each_solver, solver_name);

/// A wheel on a fixed base; the test describes the joint.
template <class Describe>
std::shared_ptr<const Model> wheel(Describe&& describe) {
  RobotBuilder robot(JointType::fixed);
  describe(robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitY(),
                     inertial(1.0, Vector3d::Constant(wheel_inertia))));
  return robot.build();
}

TEST_P(Drives, ADisplacementDriveFollowsARamp) {
  const auto world = make_world(still(), {body_of(wheel([](Joint&) {}))});
  for (int tick = 1; tick <= 500; ++tick) {
    run(*world, 1, displacement(0.001 * tick));
    ASSERT_NEAR(joint_of(*world).q, 0.001 * tick, 1e-7);
  }
  EXPECT_NEAR(joint_of(*world).dq, 1.0, 1e-6);
}

TEST_P(Drives, ADisplacementDriveKeepsTheJointsVelocityLimit) {
  const auto world = make_world(still(), {body_of(wheel([](Joint& joint) { joint.velocity = 2.0; }))});
  run(*world, 100, displacement(1.0));
  EXPECT_NEAR(joint_of(*world).q, 0.2, 1e-6);
  run(*world, 1000, displacement(1.0));
  EXPECT_NEAR(joint_of(*world).q, 1.0, 1e-6);
}

TEST_P(Drives, AVelocityDriveIsNoStrongerThanTheEffortLimit) {
  const auto world = make_world(still(), {body_of(wheel([](Joint& joint) { joint.effort = 1.0; }))});
  run(*world, 100, velocity(10.0));
  EXPECT_NEAR(joint_of(*world).dq, 0.1 / wheel_inertia, 1e-6);
  EXPECT_NEAR(joint_of(*world).u, 1.0, 1e-6);
}

TEST_P(Drives, AVelocityDriveTellsTheEffortItTook) {
  const auto world = make_world(still(), {body_of(wheel([](Joint&) {}))});
  run(*world, 1, velocity(0.001));  // within one step of 1 ms: 1 rad/s²
  EXPECT_NEAR(joint_of(*world).u, wheel_inertia, 1e-6);
  run(*world, 1, velocity(0.001));
  EXPECT_NEAR(joint_of(*world).u, 0.0, 1e-6);
}

TEST_P(Drives, ADriveCanBeTakenAway) {
  const auto world = make_world(still(), {body_of(wheel([](Joint&) {}))});
  run(*world, 100, velocity(1.0));
  run(*world, 100, effort(0.5));
  EXPECT_NEAR(joint_of(*world).dq, 1.0 + 0.1, 1e-6);
}

TEST_P(Drives, DisplacementGoesBeforeVelocityAndVelocityBeforeEffort) {
  const auto world = make_world(still(), {body_of(wheel([](Joint&) {}))});
  run(*world, 1, {drive_effort | drive_velocity | drive_displacement, 0.001, -3.0, 1e3});
  EXPECT_NEAR(joint_of(*world).q, 0.001, 1e-6);
  run(*world, 1, {drive_effort | drive_velocity, 0.001, -3.0, 1e3});
  EXPECT_NEAR(joint_of(*world).dq, -3.0, 1e-6);
}

TEST_P(Drives, DryFrictionHoldsAgainstASmallerEffort) {
  const auto world = make_world(still(), {body_of(wheel([](Joint& joint) { joint.friction = 2.0; }))});
  run(*world, 500, effort(1.9));
  EXPECT_NEAR(joint_of(*world).q, 0.0, 1e-6);
  run(*world, 100, effort(3.0));
  EXPECT_NEAR(joint_of(*world).dq, (3.0 - 2.0) / wheel_inertia * 0.1, 1e-6);
}

TEST_P(Drives, DryFrictionStopsAWheelAndThenLeavesItThere) {
  const auto world = make_world(still(), {body_of(wheel([](Joint& joint) { joint.friction = 1.0; }))});
  run(*world, 1, velocity(0.5));
  let_go(*world, 100);
  EXPECT_NEAR(joint_of(*world).dq, 0.5 - 1.0 / wheel_inertia * 0.1, 1e-6);
  let_go(*world, 1000);
  EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-9);
}

TEST_P(Drives, ASliderKnowsTheSameDrives) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(4.0, {0.1, 0.1, 0.1})).friction = 8.0;
  const auto world = make_world(still(), {body_of(robot.build())});
  run(*world, 1, velocity(0.5));
  EXPECT_NEAR(joint_of(*world).dq, 0.5, 1e-6);
  run(*world, 1, displacement(0.1));
  EXPECT_NEAR(joint_of(*world).q, 0.1, 1e-6);
  run(*world, 1, velocity(0.5));
  let_go(*world, 100);
  EXPECT_NEAR(joint_of(*world).dq, 0.5 - 8.0 / 4.0 * 0.1, 1e-4);
}

}  // namespace
}  // namespace rehearse
