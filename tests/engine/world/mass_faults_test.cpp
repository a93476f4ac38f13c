// Parts of a body that are heavier for a time, against their closed forms.
#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class MassFaults : public EachSolver {
 protected:
  static constexpr double step = 0.001;                             // [s]
  static constexpr double heavier = 2.5, begin = 0.01, end = 0.02;  // from tick 10 to tick 20

  static WorldBody with_fault(WorldBody body, int link = 0, double factor = heavier) {
    body.mass_faults.push_back({link, factor, begin, end});
    return body;
  }
  /// A fixed base, a part of two links that slides up and down, and a force sensor between the two.
  static std::shared_ptr<const Model> lift() {
    RobotBuilder robot(JointType::fixed);
    robot.add("CARRIAGE", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(2.0, Vector3d::Constant(0.1)));
    robot.add("PAYLOAD", 1, JointType::fixed, Vector3d::UnitX(), inertial(3.0, Vector3d::Constant(0.1)),
              at(0.2, 0.0, 0.0));
    robot.add_device("Sensor", 2, ForceSensor{});
    return robot.build();
  }
  static bool acts_after(int steps) { return steps > 10 && steps <= 20; }
};
INSTANTIATE_TEST_SUITE_P(Solver, MassFaults, each_solver, solver_name);

// On paper: v(t) = F t / m, with the mass of each step.
TEST_P(MassFaults, AForceAcceleratesTheMassOfTheStep) {
  const auto world =
      make_world(weightless(GetParam()), {with_fault(free_box("Box", {0.1, 0.2, 0.3}, 4.0, Vector3d::Zero()))});
  double v = 0.0;
  Command command = idle(*world);
  for (int i = 1; i <= 30; ++i) {
    command.bodies[0].external[0].force = {8.0, 0.0, 0.0};
    world->actuate(command);
    ASSERT_TRUE(world->step());
    v += 8.0 * step / (acts_after(i) ? heavier * 4.0 : 4.0);
    ASSERT_NEAR(link_of(*world).velocity.x(), v, 1e-12) << i;
  }
}

TEST_P(MassFaults, AnEffortAcceleratesTheInertiaOfTheStep) {
  RobotBuilder robot(JointType::fixed);
  robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
  const auto world = make_world(weightless(GetParam()), {with_fault(body_of(robot.build()), 1)});
  double v = 0.0;
  for (int i = 1; i <= 30; ++i) {
    run(*world, 1, effort(3.0));
    v += 3.0 * step / (acts_after(i) ? heavier * wheel_inertia : wheel_inertia);
    ASSERT_NEAR(joint_of(*world).dq, v, 1e-9) << i;
  }
}

// Nothing acts on a body that tumbles about its middle axis: its motion doesn't depend on its mass.
TEST_P(MassFaults, NothingIsPushedWhenItBeginsAndEnds) {
  WorldBody box = free_box("Box", {0.1, 0.2, 0.4}, 4.0, Vector3d::Zero());
  box.linear_velocity = {1.0, -2.0, 0.5};
  box.angular_velocity = {0.1, 9.0, 0.1};
  const auto world = make_world(weightless(GetParam()), {with_fault(box)});
  const auto light = make_world(weightless(GetParam()), {box});
  for (int i = 1; i <= 30; ++i) {
    ASSERT_TRUE(world->step());
    ASSERT_TRUE(light->step());
    expect_near(link_of(*world).velocity, link_of(*light).velocity, 1e-12);
    expect_near(link_of(*world).angular_velocity, link_of(*light).angular_velocity, 1e-11);
  }
}

// On paper a drive that holds a part exerts m g, and a force sensor measures the weight behind it, of the whole part.
TEST_P(MassFaults, LinksThatAreFixedToEachOtherAreOnePart) {
  WorldBody body = with_fault(body_of(lift()), 1);
  const auto world = make_world(settings(), {body});
  for (int i = 1; i <= 30; ++i) {
    run(*world, 1, velocity(0.0));
    const double factor = acts_after(i) ? heavier : 1.0;
    ASSERT_NEAR(joint_of(*world).u, factor * 5.0 * standard_gravity, 1e-3) << i;
    ASSERT_NEAR(device_of(*world, 0)[2], -factor * 3.0 * standard_gravity, 1e-3) << i;
  }
  EXPECT_NEAR(joint_of(*world).q, 0.0, 1e-6);
}

TEST_P(MassFaults, AFloorBearsTheWeight) {
  std::vector<WorldBody> bodies{free_box("Box", {0.2, 0.2, 0.2}, 2.0, {0.0, 0.0, 0.1}), floor_body()};
  bodies[0].mass_faults.push_back({0, heavier, 1.0, 2.0});
  const auto world = make_world(settings(), bodies);
  world->watch(0, 0);
  const auto borne = [&] {
    double force = 0.0;
    for (const ContactReading& contact : world->sense().bodies[0].contacts[0]) force += contact.force.z();
    return force;
  };
  run(*world, 900);
  EXPECT_NEAR(borne(), 2.0 * standard_gravity, 0.1);
  run(*world, 1000);
  EXPECT_NEAR(borne(), heavier * 2.0 * standard_gravity, 0.1);
  run(*world, 1000);
  EXPECT_NEAR(borne(), 2.0 * standard_gravity, 0.1);
}

TEST_P(MassFaults, ABodyThatSleepsWakes) {
  WorldSettings sleepy = settings();
  sleepy.solver.sleep_after = 0.2;
  std::vector<WorldBody> bodies{free_box("Box", {0.2, 0.2, 0.2}, 2.0, {0.0, 0.0, 0.1}), floor_body()};
  bodies[0].mass_faults.push_back({0, heavier, 1.0, 2.0});
  const auto world = make_world(sleepy, bodies), restored = make_world(sleepy, bodies);
  world->watch(0, 0);
  run(*world, 1500);  // it sleeps again, with its new weight
  EXPECT_TRUE(link_of(*world).velocity.isZero(0.0));
  double force = 0.0;
  for (const ContactReading& contact : world->sense().bodies[0].contacts[0]) force += contact.force.z();
  EXPECT_NEAR(force, heavier * 2.0 * standard_gravity, 0.2);
  ASSERT_TRUE(restored->restore(world->save()));  // the mass that it takes there is no news
  run(*restored, 100);
  run(*world, 100);
  EXPECT_EQ(restored->state_hash(), world->state_hash());
}

TEST_P(MassFaults, AStateGoesOnInTheMiddleOfAFault) {
  WorldBody body = with_fault(body_of(lift()), 1);
  const auto world = make_world(settings(), {body}), restored = make_world(settings(), {body}),
             taken = make_world(settings(), {body});
  run(*world, 15, effort(40.0));
  const auto state = world->save();
  ASSERT_TRUE(restored->restore(state));
  ASSERT_TRUE(taken->take_state(*world));
  for (World* each : {world.get(), restored.get(), taken.get()}) run(*each, 30, effort(40.0));
  EXPECT_EQ(restored->state_hash(), world->state_hash());
  EXPECT_EQ(taken->state_hash(), world->state_hash());
  ASSERT_TRUE(world->restore(state));  // back into the fault, from after it
  run(*world, 30, effort(40.0));
  EXPECT_EQ(restored->state_hash(), world->state_hash());
}

TEST_P(MassFaults, AFactorOfOneChangesNoBit) {
  const auto world = make_world(settings(), {with_fault(body_of(loaded_arm()), 3, 1.0)});
  const auto plain = make_world(settings(), {body_of(loaded_arm())});
  run(*world, 30, effort(3.0));
  run(*plain, 30, effort(3.0));
  EXPECT_EQ(world->state_hash(), plain->state_hash());
}

TEST_P(MassFaults, SeveralMultiply) {
  WorldBody box = free_box("Box", {0.1, 0.2, 0.3}, 4.0, Vector3d::Zero());
  box.mass_faults = {{0, 2.0}, {0, 3.0, 0.01}};
  const auto world = make_world(weightless(GetParam()), {box});
  const auto pushed = [&] {
    Command command = idle(*world);
    command.bodies[0].external[0].force = {24.0, 0.0, 0.0};
    const double before = link_of(*world).velocity.x();
    world->actuate(command);
    EXPECT_TRUE(world->step());
    return (link_of(*world).velocity.x() - before) / step;
  };
  EXPECT_NEAR(pushed(), 3.0, 1e-9);
  run(*world, 10);
  EXPECT_NEAR(pushed(), 1.0, 1e-9);
}

}  // namespace
}  // namespace rehearse
