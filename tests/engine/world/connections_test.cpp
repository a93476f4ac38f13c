// Welds, loops, spherical joints, holders and rotors, compared with mechanics on paper.

#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Connecting : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Connecting, each_solver, solver_name);

WorldBody fixed_box(const std::string& name, const Vector3d& position) {
  WorldBody box = free_box(name, Vector3d::Constant(0.2), 0.0, position);
  box.fixed = true;
  return box;
}

Connection weld(int body, int other_body) {
  Connection connection;
  connection.name = "weld";
  connection.body = body;
  connection.other_body = other_body;
  return connection;
}

TEST_P(Connecting, AWeldHoldsABeamAtItsEnd) {
  WorldSettings settings = this->settings();
  settings.connections = {weld(0, 1)};
  // 10 kg, whose centre is 0.5 m beside the wall: 98 N and 49 N·m
  const auto world =
      make_world(settings, {fixed_box("Wall", {0, 0, 1}), free_box("Beam", {0.6, 0.1, 0.1}, 10.0, {0.5, 0.0, 1.0})});
  run(*world, 1000);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 1.0, 2e-4);
  EXPECT_NEAR(link_of(*world, 0, 1).rotation.y(), 0.0, 2e-4);
  EXPECT_TRUE(world->events().empty());  // it is there from the beginning on
}

TEST_P(Connecting, AWeldForATimeLetsGo) {
  WorldSettings settings = this->settings();
  settings.connections = {weld(0, 1)};
  settings.connections[0].from = 0.1;
  settings.connections[0].until = 0.3;
  const auto world =
      make_world(settings, {fixed_box("Wall", {0, 0, 1}), free_box("Box", Vector3d::Constant(0.1), 1.0, {1, 0, 5})});
  const auto height = [&] { return link_of(*world, 0, 1).position.z(); };
  run(*world, 101);
  ASSERT_EQ(world->events().size(), 1u);
  EXPECT_EQ(world->events()[0], "'weld' connects 'Wall/Wall' and 'Box/Box'");
  EXPECT_NEAR(height(), 5.0 - 0.5 * standard_gravity * 0.01, 2e-3);
  run(*world, 100);
  const double held = height();
  run(*world, 99);
  EXPECT_NEAR(height(), held, 1e-4);
  run(*world, 1);
  ASSERT_EQ(world->events().size(), 1u);
  EXPECT_EQ(world->events()[0], "'weld' separates 'Wall/Wall' and 'Box/Box'");
  run(*world, 99);
  EXPECT_NEAR(height(), held - 0.5 * standard_gravity * 0.01, 1e-3);
}

TEST_P(Connecting, WeldedLinksDontTouchEachOther) {
  WorldSettings settings = this->settings();
  settings.connections = {weld(1, 2)};
  const auto world = make_world(settings, {floor_body(), free_box("A", Vector3d::Constant(0.2), 1.0, {0.0, 0.0, 0.1}),
                                           free_box("B", Vector3d::Constant(0.2), 1.0, {0.15, 0.0, 0.1})});
  run(*world, 10);
  for (const LinkPair& pair : world->touching()) EXPECT_EQ(pair.body, 0);
  EXPECT_FALSE(world->touching().empty());
}

TEST_P(Connecting, ASphericalJointIsAPendulumInBothPlanes) {
  WorldSettings settings = this->settings();
  settings.solver.erp = 0.8;
  Connection ball = weld(0, 1);
  ball.type = LoopJoint::Type::spherical;
  settings.connections = {ball};
  WorldBody bob = free_box("Bob", Vector3d::Constant(0.02), 1.0, {0.01, 0.02, 0.0});
  bob.position.z() = 2.0 - std::sqrt(1.0 - 0.01 * 0.01 - 0.02 * 0.02);
  const auto world = make_world(settings, {fixed_box("Hook", {0, 0, 2}), bob});
  // T = 2 pi sqrt((l² + r²) / (g l)) of a small swing; r: radius of gyration
  const double period = 2.0 * pi * std::sqrt((1.0 + 0.02 * 0.02 / 6.0) / standard_gravity);
  run(*world, static_cast<int>(std::lround(period * 1000.0)));
  EXPECT_NEAR(link_of(*world, 0, 1).position.x(), 0.01, 1e-4);
  EXPECT_NEAR(link_of(*world, 0, 1).position.y(), 0.02, 1e-4);
}

/// A parallelogram of two cranks of 0.3 m and a coupler of 0.5 m; the second crank is joined to the coupler by a loop.
std::shared_ptr<const Model> four_bar() {
  RobotBuilder robot(JointType::fixed);
  const Inertial crank = inertial(0.5, {1e-3, 4e-3, 4e-3}, {0.15, 0.0, 0.0});
  robot.add("CRANK", 0, JointType::continuous, Vector3d::UnitZ(), crank);
  robot.add("COUPLER", 1, JointType::continuous, Vector3d::UnitZ(), inertial(1.0, {1e-3, 2e-2, 2e-2}, {0, -0.25, 0}),
            at(0.3, 0.0, 0.0));
  robot.add("ROCKER", 0, JointType::continuous, Vector3d::UnitZ(), crank, at(0.0, -0.5, 0.0));
  LoopJoint loop;
  loop.name = "loop";
  loop.link = 2;
  loop.other_link = 3;
  loop.frame = at(0.0, -0.5, 0.0);
  loop.other_frame = at(0.3, 0.0, 0.0);
  loop.axis = Vector3d::UnitZ();
  robot.add_loop(loop);
  return robot.build();
}

double gap(const World& world) {
  const LinkReading &coupler = link_of(world, 2), &rocker = link_of(world, 3);
  return (coupler.position + coupler.rotation * Vector3d(0.0, -0.5, 0.0) - rocker.position -
          rocker.rotation * Vector3d(0.3, 0.0, 0.0))
      .norm();
}

/// Without a second frame the loop is closed where it begins.
TEST_P(Connecting, ALoopWithoutASecondFrameStaysAsItBegins) {
  Model model = *four_bar();
  model.loops.front().other_frame = at(7.0, 0.0, 0.0);
  model.loops.front().has_other_frame = false;
  const auto world = make_world(settings(), {body_of(std::make_shared<const Model>(model))});
  run(*world, 1000, velocity(1.0));
  EXPECT_LT(gap(*world), 1e-4);
  EXPECT_NEAR(joint_of(*world, 2).q, joint_of(*world, 0).q, 2e-3);
}

TEST_P(Connecting, AFourBarLinkageStaysClosedAndRepeats) {
  const auto world = make_world(settings(), {body_of(four_bar())});
  double worst = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    run(*world, 1, velocity(1.0));
    worst = std::max(worst, gap(*world));
    // the rocker of a parallelogram turns with the crank
    ASSERT_NEAR(joint_of(*world, 2).q, joint_of(*world, 0).q, 2e-3) << tick;
  }
  EXPECT_LT(worst, 1e-4);
  const auto state = world->save();
  run(*world, 500, velocity(1.0));
  const std::uint64_t end = world->state_hash();
  ASSERT_TRUE(world->restore(state).ok());
  run(*world, 500, velocity(1.0));
  EXPECT_EQ(world->state_hash(), end);
}

TEST_P(Connecting, AStateOfAWeldGoesIntoAnotherWorld) {
  WorldSettings settings = this->settings();
  settings.connections = {weld(0, 1)};
  settings.connections[0].from = 0.1;
  settings.connections[0].until = 0.5;
  const auto make = [&] {
    return make_world(settings,
                      {fixed_box("Wall", {0, 0, 1}), free_box("Box", Vector3d::Constant(0.1), 1.0, {0.5, 0.0, 1.0})});
  };
  const auto world = make(), other = make();
  run(*world, 300);  // within the weld
  ASSERT_TRUE(other->restore(world->save()).ok());
  run(*world, 400);  // beyond its end
  run(*other, 400);
  EXPECT_EQ(other->state_hash(), world->state_hash());
  const auto third = make();
  ASSERT_TRUE(third->take_state(*other).ok());
  EXPECT_EQ(third->state_hash(), other->state_hash());
}

TEST(Connections, BetweenLinksThatNeverMoveAreRefused) {
  WorldSettings settings;
  settings.connections = {weld(0, 1)};
  const auto world = World::create(settings, {floor_body(), fixed_box("Wall", {0, 0, 1})});
  ASSERT_FALSE(world.ok());
  EXPECT_EQ(world.errors()[0].message, "connection 'weld' is between links that never move against each other");
}

/// A hand that a drive lifts, with a holder 0.1 m below it.
WorldBody hand(const Holder& holder) {
  RobotBuilder robot(JointType::fixed);
  robot.add("HAND", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(1.0, Vector3d::Constant(0.01)));
  robot.add_device("GRIP", 1, holder, at(0.0, 0.0, -0.1));
  return body_of(robot.build(), {0.0, 0.0, 0.3});
}

void lift(World& world, int ticks, double to) {
  Command command = idle(world);
  command.bodies[1].joints[0] = displacement(to);
  for (int i = 0; i < ticks; ++i) {
    command.bodies[1].joints[0].q =
        world.sense().bodies[1].joints[0].q + (to - world.sense().bodies[1].joints[0].q) / (ticks - i);
    world.actuate(command);
    ASSERT_TRUE(world.step());
  }
}

TEST_P(Connecting, AHolderLiftsWhatIsNearAndLetsGo) {
  Holder holder;
  holder.max_distance = 0.12;
  const auto world = make_world(
      settings(), {floor_body(), hand(holder), free_box("Box", Vector3d::Constant(0.2), 1.0, {0.0, 0.0, 0.1})});
  lift(*world, 50, 0.0);
  world->command_device(1, 0, {1.0});
  lift(*world, 1, 0.0);
  ASSERT_EQ(world->events().size(), 1u);
  EXPECT_EQ(world->events()[0], "holder 'Robot/GRIP' took hold of 'Box/Box'");
  lift(*world, 500, 0.2);
  EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.3, 1e-3);
  const auto state = world->save();
  world->command_device(1, 0, {0.0});
  lift(*world, 300, 0.2);
  EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.1, 2e-3);  // contacts correct their depth slowly
  const std::uint64_t end = world->state_hash();
  ASSERT_TRUE(world->restore(state).ok());
  world->command_device(1, 0, {0.0});
  lift(*world, 300, 0.2);
  EXPECT_EQ(world->state_hash(), end);
}

TEST(AHolder, WaitsForItsCondition) {
  Holder by_name;
  by_name.condition = Holder::Condition::name;
  by_name.target = "Other";
  Holder by_touch;
  by_touch.condition = Holder::Condition::touch;
  for (const Holder& holder : {by_name, by_touch}) {
    const auto world =
        make_world({}, {floor_body(), hand(holder), free_box("Box", Vector3d::Constant(0.2), 1.0, {0.0, 0.0, 0.1})});
    world->command_device(1, 0, {1.0});
    lift(*world, 20, 0.0);
    EXPECT_TRUE(world->events().empty());
    EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.1, 1e-3);
  }
}

TEST_P(Connecting, ARotorOfThrustMgHovers) {
  RobotBuilder robot(JointType::free, inertial(1.5, {0.02, 0.02, 0.03}));
  robot.add_device("ROTOR", 0, Rotor{});
  const auto world = make_world(settings(), {body_of(robot.build(), {0.0, 0.0, 1.0})});
  const auto command = [&](double thrust, double torque) {
    world->command_device(0, 0, {1, 0, 0, 0, 0, 0, 1, thrust, -100, 100, torque, -100, 100});
  };
  command(1.5 * standard_gravity, 0.0);
  run(*world, 1000);
  EXPECT_NEAR(link_of(*world).position.z(), 1.0, 1e-9);
  const auto state = world->save();
  command(1.5 * (standard_gravity + 2.0), 0.03);  // 2 m/s² up, 1 rad/s² about z
  run(*world, 500);
  EXPECT_NEAR(link_of(*world).velocity.z(), 1.0, 1e-9);
  EXPECT_NEAR(link_of(*world).angular_velocity.z(), 0.5, 1e-9);
  ASSERT_TRUE(world->restore(state).ok());  // the command is state
  run(*world, 500);
  EXPECT_NEAR(link_of(*world).position.z(), 1.0, 1e-9);
  world->command_device(0, 0, {0, 0, 0, 0, 0, 0, 1, 20, -100, 100, 0, -100, 100});  // turned off
  run(*world, 100);
  EXPECT_NEAR(link_of(*world).velocity.z(), -0.1 * standard_gravity, 1e-9);
}

}  // namespace
}  // namespace rehearse
