// Contact measurements: contacts of watched links, and contact sensors.

#include <numeric>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double box_mass = 2.0;                            // of the boxes [kg]
constexpr double box_weight = box_mass * standard_gravity;  // [N]

class Touching : public EachSolver {
 protected:
  /// A box of 0.2 m that lies on the floor at x = 0.5, `box_first` or after it.
  std::unique_ptr<World> lying_box(bool box_first = false) const {
    std::vector<WorldBody> bodies{floor_body(), free_box("Box", {0.2, 0.2, 0.2}, box_mass, {0.5, 0, 0.1})};
    if (box_first) std::swap(bodies[0], bodies[1]);
    return make_world(settings(), bodies);
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Touching, each_solver, solver_name);

const std::vector<ContactReading>& contacts_of(const World& world, int body, int link = 0) {
  return world.sense().bodies[body].contacts.at(link);
}

Vector3d force_at(const std::vector<ContactReading>& contacts) {
  return std::accumulate(
      contacts.begin(), contacts.end(), Vector3d(Vector3d::Zero()),
      [](const Vector3d& sum, const ContactReading& contact) { return Vector3d(sum + contact.force); });
}

TEST_P(Touching, ABoxThatLiesIsHeldAtItsFourCorners) {
  for (const bool box_first : {false, true}) {
    const auto world = lying_box(box_first);
    const int box = box_first ? 0 : 1;
    world->watch(box, 0);
    run(*world, 1000);
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < 200; ++i) {
      run(*world, 1);
      mean += force_at(contacts_of(*world, box)) / 200;
    }
    expect_near(mean, Vector3d(0, 0, box_weight), 0.05);
    const auto& contacts = contacts_of(*world, box);
    ASSERT_EQ(contacts.size(), 4u);
    const double middle = link_of(*world, 0, box).position.x();
    for (const ContactReading& contact : contacts) {
      EXPECT_NEAR(std::abs(contact.position.x() - middle), 0.1, 1e-3);
      EXPECT_NEAR(std::abs(contact.position.y()), 0.1, 1e-3);
      EXPECT_NEAR(contact.position.z(), 0.0, 1e-3);
      expect_near(contact.normal, Vector3d(0, 0, 1), 1e-3);
      EXPECT_LT(contact.velocity.norm(), 1e-2);
      EXPECT_GT(contact.depth, 0.0);
      EXPECT_LT(contact.depth, 1e-3);
    }
  }
}

TEST_P(Touching, AWorldTellsWhichLinksTouchAfterAStepAndTheEarlierBodyFirst) {
  for (const bool box_first : {false, true}) {
    const auto world = lying_box(box_first);
    EXPECT_TRUE(world->touching().empty()) << "before the first step";
    run(*world, 1);
    EXPECT_EQ(world->touching(), std::vector<LinkPair>{(LinkPair{0, 0, 1, 0})}) << "four points, one pair";
    world->push(box_first ? 0 : 1, 0, {0, 0, 5000}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 2);
    EXPECT_TRUE(world->touching().empty()) << "it flies";
  }
}

TEST_P(Touching, WhatNoForceMovesTouchesNothing) {
  const auto world = make_world(settings(), {floor_body(), floor_body()});
  run(*world, 1);
  EXPECT_TRUE(world->touching().empty());
}

TEST_P(Touching, WhatTouchesIsNotPartOfTheState) {
  const auto world = lying_box();
  run(*world, 10);
  const auto state = world->save();
  ASSERT_TRUE(world->restore(state).ok());
  EXPECT_TRUE(world->touching().empty());
  run(*world, 1);
  EXPECT_EQ(world->touching().size(), 1u);
}

TEST_P(Touching, BothSidesTellTheSameFromTheirOwnPointOfView) {
  for (const bool box_first : {false, true}) {
    const auto world = lying_box(box_first);
    world->watch(0, 0);
    world->watch(1, 0);
    world->push(box_first ? 0 : 1, 0, {30, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 1);
    const auto &one = contacts_of(*world, 0), &other = contacts_of(*world, 1);
    ASSERT_EQ(one.size(), 4u);
    ASSERT_EQ(other.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(one[i].position, other[i].position);
      EXPECT_EQ(one[i].normal, Vector3d(-other[i].normal));
      EXPECT_EQ(one[i].force, Vector3d(-other[i].force));
      EXPECT_EQ(one[i].velocity, Vector3d(-other[i].velocity));
      EXPECT_EQ(one[i].depth, other[i].depth);
    }
    EXPECT_GT(force_at(contacts_of(*world, box_first ? 0 : 1)).z(), 0.0);
  }
}

TEST_P(Touching, TheForcesAreWhatChangesTheMomentum) {
  const auto world = make_world(settings(), {floor_body(), free_box("Box", {0.2, 0.2, 0.2}, box_mass, {0, 0, 0.15})});
  world->watch(1, 0);
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    world->push(1, 0, {10, 3, 0}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 1);
    const Vector3d needed = box_mass * link_of(*world, 0, 1).acceleration + Vector3d(-10, -3, box_weight);
    expect_near(force_at(contacts_of(*world, 1)), needed, 1e-6);
    touching += contacts_of(*world, 1).empty() ? 0 : 1;
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(touching, 250);  // it fell first
}

TEST_P(Touching, WhatSlidesIsHeldBackByFrictionAgainstItsVelocity) {
  WorldSettings icy = settings();
  icy.solver.friction = 0.2;
  const auto world = make_world(icy, {floor_body(), free_box("Box", {0.4, 0.4, 0.1}, box_mass, {0, 0, 0.05})});
  world->watch(1, 0);
  run(*world, 200);
  for (int i = 0; i < 100; ++i) {
    world->push(1, 0, {20, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 1);
  }
  EXPECT_NEAR(force_at(contacts_of(*world, 1)).x(), -0.2 * box_weight, 0.3);
  for (const ContactReading& contact : contacts_of(*world, 1))
    EXPECT_NEAR(contact.velocity.x(), link_of(*world, 0, 1).velocity.x(), 1e-2);
  EXPECT_GT(link_of(*world, 0, 1).velocity.x(), 0.5);
}

TEST_P(Touching, ARunningBeltsSurfaceIsWhatTouches) {
  RobotBuilder robot(JointType::fixed);
  robot.add("BELT", 0, JointType::track, Vector3d::UnitY(), {}, at(0, 0, -0.1));
  robot.add_collision(1, Box{{4.0, 1.0, 0.2}});
  for (const bool belt_first : {true, false}) {
    std::vector<WorldBody> bodies{body_of(robot.build()), free_box("Parcel", {0.2, 0.2, 0.2}, box_mass, {0, 0, 0.1})};
    if (!belt_first) std::swap(bodies[0], bodies[1]);
    const int belt = belt_first ? 0 : 1;
    const auto world = make_world(settings(), bodies);
    world->watch(belt, 1);
    Command command = idle(*world);
    command.bodies[belt].joints[0] = velocity(0.4);
    for (int i = 0; i < 3; ++i) {
      world->actuate(command);
      ASSERT_TRUE(world->step());
    }
    ASSERT_FALSE(contacts_of(*world, belt, 1).empty());
    const double parcel = link_of(*world, 0, 1 - belt).velocity.x();
    for (const ContactReading& contact : contacts_of(*world, belt, 1))
      EXPECT_NEAR(contact.velocity.x(), 0.4 - parcel, 1e-2);
  }
}

TEST_P(Touching, WatchingChangesNothing) {
  const auto pile = [this] {
    WorldBody tilted = free_box("Tilted", {0.2, 0.2, 0.2}, box_mass, {0.55, 0.02, 0.45});
    tilted.rotation = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0).normalized());
    return make_world(settings(), {floor_body(), free_box("Box", {0.2, 0.2, 0.2}, box_mass, {0.5, 0, 0.1}), tilted});
  };
  const auto watched = pile(), alone = pile();
  for (int body = 0; body < 3; ++body) watched->watch(body, 0);
  for (int i = 0; i < 600; ++i) {
    run(*watched, 1);
    run(*alone, 1);
    ASSERT_EQ(watched->state_hash(), alone->state_hash()) << "after tick " << i;
  }
  EXPECT_FALSE(contacts_of(*watched, 2).empty());
  EXPECT_TRUE(alone->sense().bodies[2].contacts.empty());
}

TEST_P(Touching, OnlyWatchedLinksAreTold) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  for (const double x : {-0.5, 0.5}) {
    robot.add(x < 0 ? "REAR" : "FRONT", 0, JointType::fixed, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}),
              at(x, 0, 0));
    robot.add_collision(x < 0 ? 1 : 2, Box{{0.2, 0.2, 0.2}});
  }
  const auto world = make_world(settings(), {body_of(robot.build(), {0, 0, 0.1}), floor_body()});
  world->watch(0, 2);
  run(*world, 300);
  ASSERT_EQ(world->sense().bodies[0].contacts.size(), 3u);
  EXPECT_TRUE(contacts_of(*world, 0, 1).empty());
  ASSERT_EQ(contacts_of(*world, 0, 2).size(), 4u);
  for (const ContactReading& contact : contacts_of(*world, 0, 2)) EXPECT_GT(contact.position.x(), 0.3);
  EXPECT_TRUE(world->sense().bodies[1].contacts.empty());
}

TEST_P(Touching, IsOverWhenTheLinkHasLeft) {
  const auto world = lying_box();
  world->watch(1, 0);
  run(*world, 10);
  EXPECT_FALSE(contacts_of(*world, 1).empty());
  for (int i = 0; i < 50; ++i) {
    world->push(1, 0, {0, 0, 100}, Vector3d::Zero(), Vector3d::Zero());
    run(*world, 1);
  }
  EXPECT_TRUE(contacts_of(*world, 1).empty());
}

TEST_P(Touching, IsNotKnownAfterARestoreUntilTheNextStep) {
  const auto world = lying_box();
  world->watch(1, 0);
  run(*world, 10);
  const auto state = world->save();
  run(*world, 1);
  const Vector3d expected = force_at(contacts_of(*world, 1));
  ASSERT_TRUE(world->restore(state).ok());
  EXPECT_TRUE(contacts_of(*world, 1).empty());
  run(*world, 1);
  EXPECT_EQ(force_at(contacts_of(*world, 1)), expected);
  EXPECT_FALSE(contacts_of(*world, 1).empty());
}

// Contact sensors.

/// A table on three balls: one 0.4 m before its middle, which so carries a third of it, two 0.2 m behind. A sensor of
/// all its shapes and one of the front ball, whose frame is turned: its x axis points down.
std::shared_ptr<const Model> table() {
  RobotBuilder robot(JointType::free, inertial(box_mass, {0.1, 0.2, 0.2}));
  robot.add_collision(0, Sphere{0.1}).pose = at(0.4, 0, 0);
  for (const double y : {0.3, -0.3}) robot.add_collision(0, Sphere{0.1}).pose = at(-0.2, y, 0);
  robot.add_device("All", 0, ContactSensor{});
  Eigen::Isometry3d turned = at(0, 0, 0);
  turned.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix();
  robot.add_device("Front", 0, ContactSensor{0}, turned);
  return robot.build();
}

Eigen::VectorXd mean_of(World& world, int device, int ticks) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(4);
  for (int i = 0; i < ticks; ++i) {
    run(world, 1);
    mean += device_of(world, device) / ticks;
  }
  return mean;
}

TEST_P(Touching, AContactSensorCountsPointsAndAddsUpForces) {
  const auto world = make_world(settings(), {body_of(table(), {0, 0, 0.1}), floor_body()});
  run(*world, 1000);
  expect_near(mean_of(*world, 0, 200), Eigen::Vector4d(3, 0, 0, box_weight), 0.05);
}

TEST_P(Touching, AContactSensorOfOneShapeFeelsNoOtherAndSpeaksInItsFrame) {
  const auto world = make_world(settings(), {body_of(table(), {0, 0, 0.1}), floor_body()});
  run(*world, 1000);
  expect_near(mean_of(*world, 1, 200), Eigen::Vector4d(1, -box_weight / 3, 0, 0), 0.05);
}

TEST_P(Touching, AContactSensorInTheAirReadsZero) {
  const auto world = make_world(settings(), {body_of(table(), {0, 0, 1}), floor_body()});
  EXPECT_EQ(device_of(*world, 0), Eigen::VectorXd::Zero(4));
  EXPECT_FALSE(world->sense().bodies[0].devices[0].fresh);
  run(*world, 10);
  EXPECT_EQ(device_of(*world, 0), Eigen::VectorXd::Zero(4));
  EXPECT_TRUE(world->sense().bodies[0].devices[0].fresh);
}

TEST_P(Touching, AContactSensorIsPartOfTheState) {
  const std::vector<WorldBody> bodies{body_of(table(), {0, 0, 0.1}), floor_body()};
  const auto original = make_world(settings(), bodies), copy = make_world(settings(), bodies);
  run(*original, 50);
  ASSERT_TRUE(copy->restore(original->save()).ok());
  EXPECT_GT(device_of(*original, 0)[3], 1.0);
  for (const int device : {0, 1}) EXPECT_EQ(device_of(*copy, device), device_of(*original, device));
  EXPECT_EQ(copy->state_hash(), original->state_hash());
}

TEST_P(Touching, AKinematicFingerFeelsWhatItPushes) {
  RobotBuilder robot(JointType::fixed);
  robot.add("FINGER", 0, JointType::prismatic, Vector3d::UnitX(), {}, at(0, 0, 0.1));
  robot.add_collision(1, Box{{0.1, 0.1, 0.1}});
  robot.add_device("Tip", 1, ContactSensor{});
  WorldBody finger = body_of(robot.build());
  finger.kinematic = true;
  WorldSettings icy = settings();
  icy.solver.friction = 0.0;
  const auto world =
      make_world(icy, {finger, free_box("Box", {0.2, 0.2, 0.2}, box_mass, {0.155, 0, 0.1}), floor_body()});
  double pushed = 0.0, touching = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double time = 1e-3 * (i + 1);
    run(*world, 1, displacement(0.5 * time * time));  // 1 m/s²
    if (device_of(*world, 0)[0] == 0.0) continue;
    EXPECT_LE(device_of(*world, 0)[1], 1e-9);  // the box pushes back along -x
    pushed -= device_of(*world, 0)[1] * 1e-3;
    ++touching;
  }
  EXPECT_GT(touching, 100);
  EXPECT_NEAR(pushed, box_mass * link_of(*world, 0, 1).velocity.x(), 0.02);  // the impulse that accelerated the box
  EXPECT_GT(link_of(*world, 0, 1).velocity.x(), 0.3);
}

}  // namespace
}  // namespace rehearse
