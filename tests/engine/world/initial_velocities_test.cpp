// The velocities with which bodies begin.

#include "robots.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using Eigen::Vector3d;

class InitialVelocities : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, InitialVelocities, each_solver, solver_name);

TEST_P(InitialVelocities, OfAThrownBallMakeAParabola) {
  RobotBuilder robot(JointType::free, inertial(2.0, {0.02, 0.02, 0.02}));
  WorldBody body = body_of(robot.build(), {0, 0, 1});
  body.linear_velocity = {3, 0, 4};
  body.angular_velocity = {0, 0, 2};
  const auto world = make_world(settings(), {body});
  EXPECT_EQ(link_of(*world).velocity, Vector3d(3, 0, 4));
  EXPECT_EQ(link_of(*world).angular_velocity, Vector3d(0, 0, 2));
  run(*world, 500);
  // semi-implicit: each step moves with the velocity at its end
  const double drop = standard_gravity * 1e-6 * 500 * 501 / 2;
  expect_near(link_of(*world).position, Vector3d(1.5, 0, 1 + 2 - drop), 1e-9);
  expect_near(link_of(*world).velocity, Vector3d(3, 0, 4 - standard_gravity * 0.5), 1e-9);
  expect_near(link_of(*world).angular_velocity, Vector3d(0, 0, 2), 1e-9);
}

TEST_P(InitialVelocities, AreThoseOfTheRootLinksOriginNotOfItsCentre) {
  Inertial off = inertial(2.0, {0.02, 0.02, 0.02});
  off.center = {0, 0.5, 0};
  WorldBody body = body_of(RobotBuilder(JointType::free, off).build());
  body.rotation = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ());  // the centre is at -0.5 along x
  body.linear_velocity = {1, 0, 0};
  body.angular_velocity = {0, 0, 4};
  const auto world = make_world(weightless(GetParam()), {body});
  expect_near(link_of(*world).velocity, Vector3d(1, 0, 0), 1e-12);
  run(*world, 1000);
  // The centre moves evenly, with 1 along x and 4 * -0.5 along y.
  const Vector3d centre = link_of(*world).position + link_of(*world).rotation * off.center;
  expect_near(centre, Vector3d(-0.5 + 1.0, -2.0, 0), 1e-6);
}

/// A sledge on a rail along x, with an arm on a hinge about z that is 1 m beside it.
RobotBuilder sledge_with_arm(JointType root) {
  RobotBuilder robot(root, inertial(5.0, {1, 1, 1}));
  robot.add("SLEDGE", 0, JointType::prismatic, Vector3d::UnitX(), inertial(2.0, {0.1, 0.1, 0.1}));
  robot.add("ARM", 1, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 1, 0));
  robot.add("HAND", 2, JointType::fixed, Vector3d::UnitZ(), inertial(0.1, {0.01, 0.01, 0.01}), at(0.5, 0, 0));
  return robot;
}

TEST_P(InitialVelocities, OfJointsAddUpAlongTheChain) {
  WorldBody body = body_of(sledge_with_arm(JointType::fixed).build());
  body.joint_velocities = {3.0, 2.0};
  const auto world = make_world(weightless(GetParam()), {body});
  EXPECT_NEAR(joint_of(*world, 0).dq, 3.0, 1e-12);
  EXPECT_NEAR(joint_of(*world, 1).dq, 2.0, 1e-12);
  expect_near(link_of(*world, 2).velocity, Vector3d(3, 0, 0), 1e-12);
  expect_near(link_of(*world, 3).velocity, Vector3d(3, 1, 0), 1e-12);
}

TEST_P(InitialVelocities, OfTheRootAndItsJointsSatisfyTheJoints) {
  WorldBody body = body_of(sledge_with_arm(JointType::free).build());
  body.linear_velocity = {0, 0, 1};
  body.angular_velocity = {0, 0, 2};
  body.joint_velocities = {3.0, -2.0};
  const auto world = make_world(weightless(GetParam()), {body});
  EXPECT_NEAR(joint_of(*world, 0).dq, 3.0, 1e-12);
  EXPECT_NEAR(joint_of(*world, 1).dq, -2.0, 1e-12);
  expect_near(link_of(*world, 2).angular_velocity, Vector3d::Zero(), 1e-12);
  expect_near(link_of(*world, 2).velocity, Vector3d(3 - 2, 0, 1), 1e-12);
}

TEST(InitialVelocitiesOfABody, ThatCannotHaveThemAreRefused) {
  const auto refusal = [](const WorldBody& body) {
    const auto world = World::create({}, {body});
    return world ? std::string() : to_string(world.errors());
  };
  WorldBody fixed = body_of(sledge_with_arm(JointType::fixed).build());
  fixed.linear_velocity = {1, 0, 0};
  EXPECT_THAT(refusal(fixed), testing::HasSubstr("the root link is fixed, so it has no initial velocity"));
  WorldBody kinematic = body_of(sledge_with_arm(JointType::free).build());
  kinematic.kinematic = true;
  kinematic.joint_velocities = {0.0, 1.0};
  EXPECT_THAT(refusal(kinematic), testing::HasSubstr("a kinematic body has no initial velocity"));
  WorldBody short_list = body_of(sledge_with_arm(JointType::free).build());
  short_list.joint_velocities = {1.0};
  EXPECT_THAT(refusal(short_list), testing::HasSubstr("has 2 joints, but 1 initial velocities were given"));
}

}  // namespace
}  // namespace rehearse
