// A joint that mimics a leader follows it, whatever forces act on it, and the leader carries its load.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr auto direct = SolverSettings::Method::direct;

/// A gripper: two fingers on rails along x; the second moves in the opposite direction at half the speed, with an
/// offset of 0.1 m.
WorldBody gripper() {
  RobotBuilder robot(JointType::fixed);
  robot.add("LEFT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  Joint& right =
      robot.add("RIGHT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 1, 0));
  right.mimic = Mimic{0, -0.5, 0.1};
  WorldBody body = body_of(robot.build());
  body.joints = {0.0, 0.1};
  return body;
}

TEST(Mimics, FollowTheLeadersDisplacementAndSpeed) {
  const auto world = make_world(weightless(direct), {gripper()});
  for (int tick = 0; tick < 500; ++tick) {
    run(*world, 1, effort(3.0));
    ASSERT_NEAR(joint_of(*world, 1).q, 0.1 - 0.5 * joint_of(*world, 0).q, 1e-12) << tick;
  }
  EXPECT_NEAR(joint_of(*world, 0).q, 0.5 * 3.0 / 1.25 * 0.25, 1e-3);  // the leader carries a quarter of a kilogram more
  EXPECT_NEAR(joint_of(*world, 1).dq, -0.5 * joint_of(*world, 0).dq, 1e-12);
}

TEST(Mimics, HoldAgainstAForce) {
  const auto world = make_world(weightless(direct), {gripper()});
  for (int tick = 0; tick < 100; ++tick) {
    world->push(0, 2, {50.0, 0.0, 0.0}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 1, displacement(0.0));
  }
  EXPECT_NEAR(joint_of(*world, 1).q, 0.1, 1e-6);
  EXPECT_NEAR(joint_of(*world, 1).u, -50.0, 1e-3);  // the effort needed to follow
  EXPECT_NEAR(joint_of(*world, 0).u, 25.0, 1e-3);   // half of it, on the leader
}

/// A push of 50 N moves the leader backwards, as half of it would.
TEST(Mimics, PassAForceToTheirLeader) {
  const auto world = make_world(weightless(direct), {gripper()});
  for (int tick = 0; tick < 100; ++tick) {
    world->push(0, 2, {50.0, 0.0, 0.0}, Vector3d::Zero(), Vector3d::Zero());
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(joint_of(*world, 0).dq, -0.5 * 50.0 * 0.1 / 1.25, 1e-9);
}

TEST(Mimics, DontListenToCommandsOfTheirOwn) {
  const auto world = make_world(weightless(direct), {gripper()});
  run(*world, 100, displacement(0.9), 1);
  EXPECT_NEAR(joint_of(*world, 1).q, 0.1, 1e-6);
}

TEST(Mimics, AreNoStrongerThanTheirEffortLimit) {
  RobotBuilder robot(JointType::fixed);
  robot.add("LEFT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  Joint& right = robot.add("RIGHT", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  right.mimic = Mimic{0, 1.0, 0.0};
  right.effort = 10.0;
  const auto world = make_world(weightless(direct), {body_of(robot.build())});
  for (int tick = 0; tick < 100; ++tick) {
    world->push(0, 2, {50.0, 0.0, 0.0}, Vector3d::Zero(), Vector3d::Zero());
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(joint_of(*world, 1).dq, (50.0 - 10.0) * 0.1, 1e-3);
}

/// Two shafts, both of inertia 1 kg·m²; the second turns twice as fast as the first, which feels it as four of its own.
std::shared_ptr<const Model> shafts() {
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 3; ++i) {
    Joint& shaft = robot.add("SHAFT" + std::to_string(i), 0, JointType::revolute, Vector3d::UnitY(),
                             inertial(1.0, Vector3d::Ones()), at(0.0, i, 0.0));
    if (i == 1) shaft.mimic = Mimic{0, 2.0, 0.0};
    if (i == 2) shaft.mimic = Mimic{1, 0.0, 0.5};
  }
  return robot.build();
}

TEST(Mimics, AccelerateAsTheirGearsDemand) {
  WorldBody body = body_of(shafts());
  body.joints = {0.0, 0.0, 0.5};
  const auto world = make_world(weightless(direct), {body});
  for (int tick = 0; tick < 10; ++tick) {
    run(*world, 1, effort(1.0));
    EXPECT_NEAR(world->sense().bodies[0].joints[0].dq, 0.2e-3 * (tick + 1), 1e-12);
    EXPECT_NEAR(joint_of(*world, 1).u, 0.4, 1e-9);
  }
  EXPECT_NEAR(joint_of(*world, 2).q, 0.5, 1e-12);
}

/// A chain of followers: 1, 2 and 6 times the leader's speed.
TEST(Mimics, FollowJointsThatFollow) {
  Model model = *shafts();
  model.links[3].joint.mimic = Mimic{1, 3.0, 0.0};
  const auto world = make_world(weightless(direct), {body_of(std::make_shared<const Model>(model))});
  run(*world, 10, effort(1.0));
  EXPECT_NEAR(joint_of(*world, 0).dq, 1e-2 / (1.0 + 4.0 + 36.0), 1e-12);
  EXPECT_NEAR(joint_of(*world, 2).dq, 6.0 * joint_of(*world, 0).dq, 1e-12);
}

/// The damping and the rotor of a follower act on its leader by the square of the ratio.
TEST(Mimics, PassTheirDampingAndRotorToTheirLeader) {
  Model model = *shafts();
  model.links[2].joint.armature = 0.5;
  const auto light = make_world(weightless(direct), {body_of(std::make_shared<const Model>(model))});
  run(*light, 10, effort(1.0));
  EXPECT_NEAR(joint_of(*light, 0).dq, 1e-2 / (1.0 + 4.0 * 1.5), 1e-9);
  model.links[2].joint.damping = 0.5;
  const auto damped = make_world(weightless(direct), {body_of(std::make_shared<const Model>(model))});
  run(*damped, 2000, effort(1.0));
  const double damping = 4.0 * 0.5, inertia = 1.0 + 4.0 * 1.5;
  EXPECT_NEAR(joint_of(*damped, 0).dq, -std::expm1(-2.0 * damping / inertia) / damping, 1e-5);
}

/// A finger of two links of 10 g, the outer of which follows the inner one, falls freely.
class Fingers : public ::testing::TestWithParam<double> {};

TEST_P(Fingers, KeepTheirEnergy) {
  constexpr double mass = 0.01, length = 0.04;
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 2; ++i) {
    Joint& joint = robot.add("PART" + std::to_string(i), i, JointType::revolute, Vector3d::UnitY(),
                             inertial(mass, Vector3d::Constant(mass * length * length / 12.0), {length / 2, 0.0, 0.0}),
                             at(i == 0 ? 0.0 : length, 0.0, 0.0));
    if (i == 1) joint.mimic = Mimic{0, GetParam(), 0.0};
  }
  const auto world = make_world(settings_of(direct), {body_of(robot.build())});
  double most = 0.0;  // [J]
  for (int tick = 0; tick < 1000; ++tick) {
    let_go(*world, 1);
    double energy = 0.0;
    for (int link = 1; link < 3; ++link) {
      const LinkReading& seen = link_of(*world, link);
      const Vector3d arm = seen.rotation * Vector3d(length / 2, 0.0, 0.0);
      const Vector3d velocity = seen.velocity + seen.angular_velocity.cross(arm);
      energy += 0.5 * mass * velocity.squaredNorm() + mass * standard_gravity * (seen.position + arm).z() +
                mass * length * length / 24.0 * seen.angular_velocity.squaredNorm();
    }
    most = std::max(most, std::abs(energy));
    ASSERT_NEAR(joint_of(*world, 1).q, GetParam() * joint_of(*world, 0).q, 1e-4);
  }
  EXPECT_LT(most, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(OfEachRatio, Fingers, ::testing::Values(1.0, 1.1, 0.5, -1.0, 3.0));

TEST(Mimics, AreRefusedWhereTheirLoadIsLost) {
  for (const SolverSettings::Method method : {SolverSettings::Method::quick, SolverSettings::Method::exact}) {
    const auto world = World::create(settings_of(method), {gripper()});
    ASSERT_FALSE(world.ok());
    EXPECT_THAT(to_string(world.errors()), testing::HasSubstr("joint 'RIGHT' follows 'LEFT'"));
  }
}

}  // namespace
}  // namespace rehearse
