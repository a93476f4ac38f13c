// The velocities with which bodies begin.

#include <cmath>

#include <gmock/gmock.h>

#include "robots.h"

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

/// A slider on a turntable that turns at 2 rad/s. Its centre of mass is 0.3 m beside the rail.
std::shared_ptr<const Model> turntable(double damping) {
  RobotBuilder robot(JointType::fixed);
  robot.add("TABLE", 0, JointType::revolute, Vector3d::UnitZ(), inertial(5.0, {1, 1, 1}));
  robot.add("SLIDER", 1, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}, {0.0, 0.3, 0.0}))
      .damping = damping;
  return robot.build();
}

TEST_P(InitialVelocities, OfASliderAreThoseInItsTurningParent) {
  WorldBody body = body_of(turntable(0.0));
  body.joint_velocities = {2.0, 0.7};
  const auto world = make_world(weightless(GetParam()), {body});
  EXPECT_NEAR(joint_of(*world, 1).dq, 0.7, 1e-12);
}

TEST_P(InitialVelocities, OfATurntableLeaveItsSliderAtRest) {
  for (const double damping : {0.0, 10.0}) {
    WorldBody body = body_of(turntable(damping));
    body.joint_velocities = {2.0, 0.0};
    const auto world = make_world(weightless(GetParam()), {body});
    Command command = idle(*world);
    command.bodies[0].joints[0] = velocity(2.0);
    if (damping == 0.0) command.bodies[0].joints[1] = displacement(0.0);
    world->actuate(command);
    // a damper takes a while for the velocity of the first step, which isn't that of the step's middle
    const double tolerance = GetParam() != SolverSettings::Method::direct ? 1e-3 : damping > 0.0 ? 1e-6 : 1e-9;
    for (int tick = 0; tick < 500; ++tick) {
      ASSERT_TRUE(world->step());
      ASSERT_NEAR(joint_of(*world, 1).dq, 0.0, tolerance) << tick;
      ASSERT_NEAR(joint_of(*world, 1).q, 0.0, tolerance) << tick;
    }
  }
}

/// A bead slides outwards on a rod that turns freely: the rod slows down by the bead's angular momentum, and the bead
/// accelerates by r w². A step's velocities belong to its middle.
TEST(AccelerationsAfterAStartInMotion, OfABeadOnARodAreThoseOnPaper) {
  constexpr double dt = 1e-5, rod = 0.2, mass = 1.0, own = 0.1;
  RobotBuilder robot(JointType::fixed);
  robot.add("ROD", 0, JointType::revolute, Vector3d::UnitZ(), inertial(5.0, Vector3d::Constant(rod)));
  robot.add("BEAD", 1, JointType::prismatic, Vector3d::UnitX(), inertial(mass, Vector3d::Constant(own)));
  WorldBody body = body_of(robot.build());
  body.joints = {0.3, 0.5};
  body.joint_velocities = {3.0, 2.0};
  WorldSettings settings = weightless(SolverSettings::Method::direct);
  settings.time_step = dt;
  const auto world = make_world(settings, {body});
  run(*world, 1);
  for (int step = 2; step < 10; ++step) {
    const JointReading turn = joint_of(*world, 0), slide = joint_of(*world, 1);
    run(*world, 1);
    const double w = 0.5 * (turn.dq + joint_of(*world, 0).dq), v = 0.5 * (slide.dq + joint_of(*world, 1).dq);
    const double braking = -2.0 * mass * slide.q * v * w / (rod + own + mass * slide.q * slide.q);
    const double outwards = slide.q * w * w;
    EXPECT_NEAR((joint_of(*world, 0).dq - turn.dq) / dt, braking, 1e-4 * std::abs(braking)) << step;
    EXPECT_NEAR((joint_of(*world, 1).dq - slide.dq) / dt, outwards, 1e-4 * outwards) << step;
  }
}

/// Two bars of a pendulum that swing: the equations of motion of a double pendulum, angles from the vertical.
TEST(AccelerationsAfterAStartInMotion, OfADoublePendulumAreThoseOnPaper) {
  constexpr double dt = 1e-5, m = 1.0, l = 0.5, c = 0.25, inertia = 0.02;
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 2; ++i)
    robot.add("BAR" + std::to_string(i), i, JointType::revolute, Vector3d::UnitY(),
              inertial(m, Vector3d::Constant(inertia), {0.0, 0.0, -c}), at(0.0, 0.0, i == 0 ? 0.0 : -l));
  WorldBody body = body_of(robot.build());
  body.joints = {0.4, 0.9};
  body.joint_velocities = {5.0, -9.0};
  WorldSettings settings = weightless(SolverSettings::Method::direct);
  settings.time_step = dt;
  const auto world = make_world(settings, {body});
  run(*world, 1);
  for (int step = 2; step < 10; ++step) {
    const JointReading first = joint_of(*world, 0), second = joint_of(*world, 1);
    run(*world, 1);
    // M(a) ddq = -C with the bars' own angles
    const double w1 = 0.5 * (first.dq + joint_of(*world, 0).dq);
    const double w2 = w1 + 0.5 * (second.dq + joint_of(*world, 1).dq);
    const double cosine = std::cos(second.q), sine = std::sin(second.q);  // of the second bar against the first
    const double a = inertia + m * c * c + m * l * l, b = m * l * c * cosine, d = inertia + m * c * c;
    const double right1 = m * l * c * sine * w2 * w2, right2 = -m * l * c * sine * w1 * w1;
    const double det = a * d - b * b;
    const double a1 = (d * right1 - b * right2) / det, a2 = (a * right2 - b * right1) / det;
    EXPECT_NEAR((joint_of(*world, 0).dq - first.dq) / dt, a1, 1e-4 * std::abs(a1)) << step;
    EXPECT_NEAR((joint_of(*world, 1).dq - second.dq) / dt, a2 - a1, 1e-4 * std::abs(a2 - a1)) << step;
  }
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
