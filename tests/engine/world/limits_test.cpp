// Limits: applied only if the scenario enables them.

#include <numbers>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Limits : public EachSolver {
 protected:
  WorldSettings still() const { return weightless(GetParam()); }

  /// A wheel whose joint may turn from lower to upper, with an effort of at most 2 N·m or another [N·m].
  static WorldBody wheel(double lower, double upper, double most_effort = 2.0) {
    RobotBuilder robot(JointType::fixed);
    Joint& joint =
        robot.add("WHEEL", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
    joint.lower = lower;
    joint.upper = upper;
    joint.effort = most_effort;
    return body_of(robot.build());
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Limits, each_solver, solver_name);

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

TEST_P(Limits, StopADriveWithoutAJolt) {
  WorldBody body = wheel(-0.2, 0.1, 1e4);
  body.joint_limits = true;
  const auto world = make_world(still(), {body});
  for (const double target : {0.5, 0.1, -3.0}) {
    run(*world, 1500, displacement(target));
    EXPECT_NEAR(joint_of(*world).q, target < 0.0 ? -0.2 : 0.1, 1e-6);
    EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-6);
    EXPECT_NEAR(joint_of(*world).u, 0.0, 1e-6);
  }
  run(*world, 1500, velocity(0.1));
  EXPECT_NEAR(joint_of(*world).q, -0.05, 1e-6);
}

TEST_P(Limits, HoldADrivenJointAgainstALoadThatIsStrongerThanTheDrive) {
  WorldBody body = wheel(-0.2, 0.1);
  body.joint_limits = true;
  const auto world = make_world(still(), {body});
  Command command = idle(*world);
  command.bodies[0].joints[0] = displacement(0.0);  // with 2 N·m at most
  for (int tick = 0; tick < 3000; ++tick) {
    command.bodies[0].external[1].torque = {0.0, 5.0, 0.0};
    world->actuate(command);
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(joint_of(*world).q, 0.1, 5e-3);
  EXPECT_LE(std::abs(joint_of(*world).u), 2.0 + 1e-9);
}

TEST_P(Limits, TakeAJointThatBeginsBeyondThemBackSlowly) {
  WorldBody body = wheel(-0.2, 0.1);
  body.joint_limits = true;
  body.joints = {0.9};
  const auto world = make_world(still(), {body});
  double fastest = 0.0;  // [rad/s]
  for (int tick = 0; tick < 1500; ++tick) {
    const double before = joint_of(*world).q;
    run(*world, 1);
    fastest = std::max(fastest, 1e3 * std::abs(joint_of(*world).q - before));
    if (GetParam() == SolverSettings::Method::direct) {
      EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-12);
    }
  }
  EXPECT_NEAR(fastest, 1.0, 0.01);
  EXPECT_LE(joint_of(*world).q, 0.1 + 1e-3);
}

/// The direct solver's stops take the whole velocity, and the joint is at its limit.
TEST(Stops, TakeTheWholeVelocity) {
  for (const double speed : {1.0, 2.0, 5.0}) {
    RobotBuilder robot(JointType::fixed);
    Joint& joint =
        robot.add("WHEEL", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
    joint.lower = -0.2;
    joint.upper = 0.1;
    WorldBody body = body_of(robot.build());
    body.joint_limits = true;
    body.joint_velocities = {speed};
    const auto world = make_world(weightless(SolverSettings::Method::direct), {body});
    for (int tick = 0; tick < 300; ++tick) {
      let_go(*world, 1);
      ASSERT_LE(joint_of(*world).q, 0.1 + 1e-9) << speed;
    }
    EXPECT_NEAR(joint_of(*world).q, 0.1, 1e-9) << speed;
    EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-12) << speed;
  }
}

/// An arm falls onto its stop and lies there.
TEST(Stops, HoldAnArmThatFellOntoThem) {
  RobotBuilder robot(JointType::fixed);
  Joint& joint = robot.add("ARM", 0, JointType::revolute, Vector3d::UnitY(),
                           inertial(2.0, Vector3d::Constant(0.02), {0.5, 0.0, 0.0}));
  joint.lower = -0.5;
  joint.upper = 0.7;
  WorldBody body = body_of(robot.build());
  body.joint_limits = true;
  const auto world = make_world(settings_of(SolverSettings::Method::direct), {body});
  double fastest = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    let_go(*world, 1);
    ASSERT_GE(joint_of(*world).dq, -1e-9) << tick;
    ASSERT_LE(joint_of(*world).q, 0.7 + 1e-6) << tick;
    fastest = std::max(fastest, joint_of(*world).dq);
  }
  EXPECT_GT(fastest, 4.0);
  EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-9);
}

/// A joint that begins beyond its stop by 5 mrad is within it after 20 steps, and has got no velocity by that.
TEST(Stops, CorrectPositionsWithoutMomentum) {
  RobotBuilder robot(JointType::free, inertial(3.0, Vector3d::Constant(0.1)));
  Joint& joint = robot.add("ARM", 0, JointType::revolute, Vector3d::UnitY(),
                           inertial(2.0, Vector3d::Constant(0.02), {0.5, 0.0, 0.0}));
  joint.lower = -0.5;
  joint.upper = 0.1;
  WorldBody body = body_of(robot.build());
  body.joint_limits = true;
  body.joints = {0.105};
  const auto world = make_world(weightless(SolverSettings::Method::direct), {body});
  for (int tick = 0; tick < 20; ++tick) {
    let_go(*world, 1);
    for (const LinkReading& link : world->sense().bodies[0].links) {
      EXPECT_LT(link.velocity.norm(), 1e-3) << tick;
      EXPECT_LT(link.angular_velocity.norm(), 1e-3) << tick;
    }
  }
  EXPECT_NEAR(joint_of(*world).q, 0.1, 1e-5);
}

TEST(LimitsOfMimics, AreThoseOfTheLeader) {
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 2; ++i) {
    Joint& sled = robot.add("SLED" + std::to_string(i), 0, JointType::prismatic, Vector3d::UnitX(),
                            inertial(1.0, {0.1, 0.1, 0.1}));
    sled.lower = 0.0;
    sled.upper = 0.1;
    if (i == 1) sled.mimic = Mimic{0, 1.0, 0.05};
  }
  WorldBody body = body_of(robot.build());
  body.joints = {0.0, 0.05};
  body.joint_limits = true;
  const auto world = make_world(weightless(SolverSettings::Method::direct), {body});
  run(*world, 500, velocity(1.0));
  EXPECT_NEAR(joint_of(*world, 0).q, 0.1, 1e-6);
  EXPECT_NEAR(joint_of(*world, 1).q, 0.15, 1e-4);
}

TEST_P(Limits, DryFrictionDoesntPushAJointOffItsStop) {
  WorldBody body = wheel(-0.2, 0.1);
  auto model = std::make_shared<Model>(*body.model);
  model->links[1].joint.friction = 1.0;
  body.model = model;
  body.joint_limits = true;
  body.joints = {0.1};
  const auto world = make_world(still(), {body});
  run(*world, 200, effort(0.0));
  EXPECT_NEAR(joint_of(*world).q, 0.1, 1e-6);
}

}  // namespace
}  // namespace rehearse
