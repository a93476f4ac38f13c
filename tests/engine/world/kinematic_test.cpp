// Kinematic bodies: they are at their commanded poses, and push other bodies out of the way.

#include <numbers>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Kinematic : public EachSolver {
 protected:
  WorldSettings settings() const { return settings_of(GetParam()); }

  /// A plate with an arm that turns about z, a metre from its centre, and a slider on the arm that follows it.
  static WorldBody plate() {
    RobotBuilder robot(JointType::free);
    robot.add_collision(0, Box{{1.0, 1.0, 0.1}});
    Joint& arm = robot.add("ARM", 0, JointType::revolute, Vector3d::UnitZ(), {}, at(1, 0, 0));
    arm.lower = -1.0;
    arm.upper = 1.0;
    robot.add("SLIDE", 1, JointType::prismatic, Vector3d::UnitX(), {}, at(0.5, 0, 0)).mimic = Mimic{0, 0.1, 0.2};
    robot.add_device("Gyro", 1, Gyro{});
    robot.add_device("Force", 1, ForceSensor{});
    WorldBody body = body_of(robot.build(), {0, 0, 1});
    body.kinematic = true;
    body.joints = {0.0, 0.2};
    return body;
  }

  static Command move_to(const World& world, const Vector3d& position) {
    Command command = idle(world);
    command.bodies[0].given[0].place = LinkPlace{position, Eigen::Quaterniond::Identity()};
    return command;
  }

  static void step(World& world, const Command& command) {
    world.actuate(command);
    ASSERT_TRUE(world.step());
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Kinematic, each_solver, solver_name);

TEST_P(Kinematic, BodiesStayWhereTheyAreInTheAir) {
  const auto world = make_world(settings(), {plate()});
  run(*world, 100);
  EXPECT_EQ(link_of(*world).position, Vector3d(0, 0, 1));
  EXPECT_EQ(link_of(*world).velocity, Vector3d::Zero());
}

TEST_P(Kinematic, TheRootIsExactlyWhereItWasCommanded) {
  const auto world = make_world(settings(), {plate()});
  const Vector3d target(0.3, -0.2, 1.5);
  step(*world, move_to(*world, target));
  EXPECT_EQ(link_of(*world).position, target);
  expect_near(link_of(*world).velocity, (target - Vector3d(0, 0, 1)) / 0.001, 1e-9);
  EXPECT_EQ(link_of(*world, 1).position, target + Vector3d(1, 0, 0));
}

TEST_P(Kinematic, JointsAreExactlyWhereTheyWereCommandedAndLinksFollow) {
  const auto world = make_world(settings(), {plate()});
  run(*world, 1, displacement(0.5));
  EXPECT_EQ(joint_of(*world).q, 0.5);
  EXPECT_NEAR(joint_of(*world).dq, 500.0, 1e-9);
  EXPECT_NEAR(joint_of(*world, 1).q, 0.25, 1e-15);  // the slider that follows
  expect_near(link_of(*world, 1).angular_velocity, Vector3d(0, 0, 500.0), 1e-6);
  const double reach = 0.5 + 0.25;
  expect_near(link_of(*world, 2).position, Vector3d(1 + reach * std::cos(0.5), reach * std::sin(0.5), 1), 1e-12);
  EXPECT_NEAR(device_of(*world, 0).z(), 500.0, 1e-6);
  EXPECT_EQ(device_of(*world, 1).norm(), 0.0);  // nothing acts on it
}

TEST_P(Kinematic, AVelocityCommandMovesByTheStep) {
  const auto world = make_world(settings(), {plate()});
  run(*world, 100, velocity(2.0));
  EXPECT_NEAR(joint_of(*world).q, 0.2, 1e-12);
  EXPECT_NEAR(joint_of(*world).dq, 2.0, 1e-9);
}

TEST_P(Kinematic, LimitsHoldWhereTheScenarioSaysSo) {
  WorldBody body = plate();
  body.joint_limits = true;
  const auto world = make_world(settings(), {body});
  run(*world, 10, displacement(3.0));
  EXPECT_EQ(joint_of(*world).q, 1.0);
}

TEST_P(Kinematic, BodiesCarryAndAreNotCarried) {
  WorldSettings slow = settings();
  slow.solver.iterations = 200;
  const auto world = make_world(slow, {plate(), free_box("Box", {0.2, 0.2, 0.2}, 1000.0, {0, 0, 1.15})});
  double x = 0.0;
  for (int tick = 0; tick < 1000; ++tick) step(*world, move_to(*world, {x += 0.0002, 0, 1}));
  EXPECT_EQ(link_of(*world).position.z(), 1.0);
  EXPECT_NEAR(link_of(*world, 0, 1).position.x(), 0.2, 0.005);  // friction takes the box along
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.x(), 0.2, 1e-3);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 1.15, 1e-3);
}

TEST_P(Kinematic, BodiesPassThroughTheFloor) {
  const auto world = make_world(settings(), {plate(), floor_body()});
  step(*world, move_to(*world, {0, 0, 0}));
  run(*world, 10);
  EXPECT_EQ(link_of(*world).position.z(), 0.0);
}

TEST_P(Kinematic, AFixedRootStays) {
  WorldBody body = plate();
  body.fixed = true;
  const auto world = make_world(settings(), {body});
  step(*world, move_to(*world, {5, 5, 5}));
  EXPECT_EQ(link_of(*world).position, Vector3d(0, 0, 1));
}

TEST_P(Kinematic, ARestoredStateGoesOnTheSame) {
  const auto bodies = [] {
    return std::vector<WorldBody>{plate(), free_box("Box", {0.2, 0.2, 0.2}, 1.0, {0.1, 0.2, 1.15})};
  };
  const auto go_on = [](World& world, double from) {
    for (int tick = 0; tick < 100; ++tick) step(world, move_to(world, {from += 0.0003, 0, 1}));
  };
  const auto world = make_world(settings(), bodies());
  go_on(*world, 0.0);
  const auto state = world->save();
  go_on(*world, 0.03);
  const auto fresh = make_world(settings(), bodies());
  ASSERT_TRUE(fresh->restore(state).ok());
  go_on(*fresh, 0.03);
  EXPECT_EQ(fresh->state_hash(), world->state_hash());
}

}  // namespace
}  // namespace rehearse
