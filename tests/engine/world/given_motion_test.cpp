// Given motion: links that no joint guides go where a command says, whatever acts on them.

#include <algorithm>
#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Method = SolverSettings::Method;

constexpr double time_step = 0.001;  // [s]

class GivenMotionOf : public EachSolver {
 protected:
  WorldSettings settings() const { return settings_of(GetParam()); }

  static void place(World& world, const Vector3d& position, const Quaterniond& rotation = Quaterniond::Identity()) {
    Command command = idle(world);
    command.bodies[0].given[0].place = LinkPlace{position, rotation};
    world.actuate(command);
    ASSERT_TRUE(world.step());
  }

  /// A trunk of 5 kg with a link of 1 kg, half a metre off a hinge about y.
  static WorldBody pendulum_on_a_trunk() {
    RobotBuilder robot(JointType::free, inertial(5.0, Vector3d::Constant(0.1), {0.1, 0.0, 0.0}));
    robot.add("ARM", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(0.01), {0, 0, -0.5}));
    return body_of(robot.build(), {0.0, 0.0, 2.0});
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, GivenMotionOf, each_solver, solver_name);

TEST_P(GivenMotionOf, ABoxIsExactUnderALoad) {
  const auto world = make_world(settings(), {free_box("Lift", {0.5, 0.5, 0.1}, 1.0, {0.0, 0.0, 1.0}),
                                             free_box("Load", Vector3d::Constant(0.2), 100.0, {0.0, 0.0, 1.15})});
  for (int tick = 1; tick <= 500; ++tick) {
    const Vector3d wanted(0.0, 0.0, 1.0 + 0.2 * tick * time_step);
    place(*world, wanted);
    expect_near(link_of(*world).position, wanted, 1e-12);
  }
  expect_near(link_of(*world).velocity, Vector3d(0.0, 0.0, 0.2), 1e-9);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 1.25, 1e-3);
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.z(), 0.2, 1e-3);
}

TEST_P(GivenMotionOf, TheRootOfARobotCarriesItsLinks) {
  const auto world = make_world(settings(), {pendulum_on_a_trunk()});
  const Quaterniond turned(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  place(*world, {0.001, 0.0, 2.0}, turned);
  for (int tick = 0; tick < 1000; ++tick) place(*world, {0.001, 0.0, 2.0}, turned);
  expect_near(link_of(*world).position, Vector3d(0.001, 0.0, 2.0), 1e-12);
  EXPECT_NEAR(link_of(*world).rotation.angularDistance(turned), 0.0, 1e-7);
  expect_near(link_of(*world, 1).position, Vector3d(0.001, 0.0, 2.0), 1e-3);  // the joint holds
}

/// A pendulum under a support that accelerates at a [m/s²] settles about the angle atan(a / g).
TEST_P(GivenMotionOf, AnAcceleratedSupportSwingsAPendulum) {
  const auto world = make_world(settings(), {pendulum_on_a_trunk()});
  constexpr double acceleration = 1.0;
  double most = 0.0;
  for (int tick = 1; tick <= 1500; ++tick) {
    const double t = tick * time_step;
    place(*world, {0.5 * acceleration * t * t, 0.0, 2.0});
    most = std::max(most, std::abs(joint_of(*world).q));
  }
  EXPECT_NEAR(most, 2.0 * std::atan(acceleration / standard_gravity), 0.01);
}

TEST_P(GivenMotionOf, ATwistIsKept) {
  const auto world = make_world(settings(), {pendulum_on_a_trunk()});
  Command command = idle(*world);
  command.bodies[0].given[0].twist = LinkTwist{{0.0, 0.1, 0.0}, {0.0, 0.0, 1.0}};
  for (int tick = 0; tick < 200; ++tick) {
    world->actuate(command);
    ASSERT_TRUE(world->step());
    expect_near(link_of(*world).angular_velocity, Vector3d(0.0, 0.0, 1.0), 1e-9);
  }
  EXPECT_NEAR(link_of(*world).position.z(), 2.0, 1e-9);
  EXPECT_NEAR(link_of(*world).rotation.angularDistance(Quaterniond::Identity()), 0.2, 1e-6);
  expect_near(link_of(*world).velocity, Vector3d(0.0, 0.1, 0.0), 1e-3);
}

TEST_P(GivenMotionOf, ABoxFallsWhenTheCommandEnds) {
  const auto world = make_world(settings(), {free_box("Box", Vector3d::Constant(0.2), 2.0, {0.0, 0.0, 5.0})});
  for (int tick = 1; tick <= 10; ++tick) place(*world, {0.001 * tick, 0.0, 5.0});
  world->actuate(idle(*world));
  run(*world, 100);
  expect_near(link_of(*world).velocity, Vector3d(1.0, 0.0, -standard_gravity * 0.1), 1e-9);
}

TEST_P(GivenMotionOf, AStateThatIsRestoredGoesOnBitByBit) {
  const auto world = make_world(settings(), {pendulum_on_a_trunk()});
  for (int tick = 1; tick <= 50; ++tick) place(*world, {0.001 * tick, 0.0, 2.0});
  const auto state = world->save();
  const auto go_on = [&] {
    for (int tick = 51; tick <= 100; ++tick) place(*world, {0.001 * tick, 0.0, 2.0});
    return world->state_hash();
  };
  const std::uint64_t end = go_on();
  ASSERT_TRUE(world->restore(state).ok());
  EXPECT_EQ(go_on(), end);
}

/// Six joints without limits that are commanded to 1 rad within a step of 1 ms, and the tool that they carry.
TEST(ADriveWithoutLimit, ReachesAFarTargetInOneStep) {
  WorldSettings settings = settings_of(Method::direct);
  const auto world = make_world(settings, {body_of(loaded_arm())});
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[0].joints) joint = displacement(1.0);
  world->actuate(command);
  ASSERT_TRUE(world->step());
  for (int id = 0; id < 6; ++id) EXPECT_NEAR(joint_of(*world, id).q, 1.0, 1e-9) << "joint " << id;
  const auto poses = forward_kinematics(*loaded_arm(), Eigen::Isometry3d::Identity(), std::vector<double>(6, 1.0));
  expect_near(link_of(*world, 6).position, Vector3d(poses[6].translation()), 1e-9);
  run(*world, 100);
  for (int id = 0; id < 6; ++id) EXPECT_NEAR(joint_of(*world, id).q, 1.0, 1e-6) << "joint " << id;
}

}  // namespace
}  // namespace rehearse
