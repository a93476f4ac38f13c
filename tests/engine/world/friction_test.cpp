// Friction that is equal in all directions, compared with Coulomb's law on paper: threshold, deceleration, direction.

#include <algorithm>
#include <cmath>
#include <span>

#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double mu = 0.5;

struct Sled {
  const char* name;
  std::vector<Geometry> feet;  // one: under its centre; three: on a circle
};

/// Bodies that slide without rolling, on each kind of shape.
std::vector<Sled> sleds() {
  const Box foot{{0.05, 0.05, 0.05}};
  return {{"box", {Box{{0.3, 0.3, 0.05}}}},
          {"hull", {box_mesh({0.3, 0.3, 0.05})}},
          {"cylinder", {Cylinder{0.15, 0.05}}},
          {"boxes", {foot, foot, foot}},
          {"hulls", {box_mesh(foot.size), box_mesh(foot.size), box_mesh(foot.size)}},
          {"spheres", {Sphere{0.025}, Sphere{0.025}, Sphere{0.025}}},
          {"capsules", {Capsule{0.01, 0.03}, Capsule{0.01, 0.03}, Capsule{0.01, 0.03}}},
          {"cylinders", {Cylinder{0.025, 0.05}, Cylinder{0.025, 0.05}, Cylinder{0.025, 0.05}}}};
}

constexpr double sled_mass = 2.0;  // [kg]

WorldBody sled_body(const Sled& sled) {
  RobotBuilder robot(JointType::free, inertial(sled_mass, {0.01, 0.01, 0.02}));
  for (std::size_t i = 0; i < sled.feet.size(); ++i) {
    Shape& shape = robot.add_collision(0, sled.feet[i]);
    const double angle = 2.0 * pi * static_cast<double>(i) / 3.0 + 0.3;
    if (sled.feet.size() == 3) shape.pose.translation() = 0.12 * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  }
  return body_of(robot.build(), {0, 0, 0.025 - 1e-4});
}

/// Grounds whose top is at z = 0.
WorldBody hull_floor() {
  return fixed(body_with("Floor", box_mesh({10, 10, 0.2}), Box{{10, 10, 0.2}}, 0.0, {0, 0, -0.1}));
}
WorldBody trimesh_floor() {
  return trimesh_body("Floor", ground_mesh(7, [](double, double) { return 0.0; }), {0.13, 0.07, 0});
}

/// Gravity on a slope of that angle that falls along `down` (level, unit).
Vector3d slope_gravity(double slope, const Vector3d& down) {
  return standard_gravity * (std::sin(slope) * down - std::cos(slope) * Vector3d::UnitZ());
}

Vector3d heading_of(int degrees) {
  const double angle = degrees * pi / 180.0;
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// The component to the left of a level heading.
double left_of(const Vector3d& v, const Vector3d& heading) { return v.dot(Vector3d::UnitZ().cross(heading)); }

constexpr int headings[] = {0, 10, 30, 45, 67, 200};  // [degrees]

class IsotropicFriction : public EachSolver {
 protected:
  WorldSettings settings(const Vector3d& gravity = {0, 0, -standard_gravity}) const {
    WorldSettings settings = settings_of(GetParam());
    settings.solver.friction = mu;
    settings.gravity = gravity;
    return settings;
  }

  /// Accelerates the second body along `ahead` to about 1 m/s.
  static void start(World& world, const Vector3d& ahead, const Vector3d& gravity = {0, 0, -standard_gravity}) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d friction = mu * -gravity.z() * ahead;
      const Vector3d down(gravity.x(), gravity.y(), 0.0);
      world.push(1, 0, sled_mass * (20.0 * ahead + friction - down), {0, 0, -0.025}, Vector3d::Zero());
      ASSERT_TRUE(world.step());
    }
  }

  void expect_threshold(const WorldBody& ground, const Sled& sled, int degrees) const {
    const Vector3d down = heading_of(degrees);
    const auto slide = [&](double share) {
      const Vector3d gravity = slope_gravity(std::atan(share * mu), down);
      const auto world = make_world(settings(gravity), {ground, sled_body(sled)});
      run(*world, 500);
      return Vector3d(link_of(*world, 0, 1).position - Vector3d(0, 0, 0.025));
    };
    EXPECT_LT(slide(0.98).norm(), 3e-4) << "holds";
    const Vector3d way = slide(1.02);
    EXPECT_GT(way.dot(down), 0.005) << "slides";  // on paper 0.011 m
    EXPECT_NEAR(left_of(way, down), 0.0, 0.02 * way.norm());
  }

  void expect_braking(const WorldBody& ground, const Sled& sled, int degrees) const {
    const Vector3d ahead = heading_of(degrees);
    const auto world = make_world(settings(), {ground, sled_body(sled)});
    start(*world, ahead);
    const Vector3d before = link_of(*world, 0, 1).velocity, from = link_of(*world, 0, 1).position;
    run(*world, 100);
    const Vector3d braking = (before - link_of(*world, 0, 1).velocity) / 0.1;
    EXPECT_NEAR(braking.dot(ahead), mu * standard_gravity, 0.02 * mu * standard_gravity);
    EXPECT_NEAR(left_of(braking, ahead), 0.0, 0.02 * mu * standard_gravity);
    run(*world, 300);
    const Vector3d way = link_of(*world, 0, 1).position - from;
    const double expected = before.squaredNorm() / (2.0 * mu * standard_gravity);
    EXPECT_NEAR(way.dot(ahead), expected, 0.02 * expected);
    EXPECT_NEAR(left_of(way, ahead), 0.0, 0.02 * expected);
    EXPECT_LT(link_of(*world, 0, 1).velocity.norm(), 1e-3);
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, IsotropicFriction, each_solver, solver_name);

TEST_P(IsotropicFriction, HoldsAndBrakesEquallyAtEveryHeading) {
  for (const Sled& sled : sleds())
    for (const int heading : headings) {
      SCOPED_TRACE(std::string(sled.name) + ", heading " + std::to_string(heading));
      expect_threshold(floor_body(), sled, heading);
      expect_braking(floor_body(), sled, heading);
    }
}

TEST_P(IsotropicFriction, IsThatOfEveryKindOfGround) {
  for (const Sled& sled : sleds()) {
    SCOPED_TRACE(sled.name);
    expect_threshold(hull_floor(), sled, 30);
    expect_braking(hull_floor(), sled, 30);
    const std::string name = sled.name;
    if (name != "box" && name != "spheres" && name != "capsules") continue;  // others catch on a trimesh's edges
    expect_threshold(trimesh_floor(), sled, 30);
    expect_braking(trimesh_floor(), sled, 30);
  }
}

/// Coulomb's law on paper, in small steps: where a point is that begins at 0 with that velocity.
Vector3d coulomb(Vector3d velocity, const Vector3d& gravity, double time) {
  constexpr double step = 1e-6;
  const Vector3d down(gravity.x(), gravity.y(), 0.0);
  Vector3d position = Vector3d::Zero();
  for (int i = 0; i < static_cast<int>(time / step); ++i) {
    Vector3d next = velocity + step * down;
    next -= std::min(1.0, step * mu * -gravity.z() / next.norm()) * next;
    position += 0.5 * step * (velocity + next);
    velocity = next;
  }
  return position;
}

TEST_P(IsotropicFriction, TurnsASledThatCrossesASlopeDownhill) {
  for (const double steepness : {0.8, 1.2})
    for (const int heading : {20, 77}) {
      SCOPED_TRACE(steepness);
      const Vector3d down = heading_of(heading), across = heading_of(heading + 90);
      const Vector3d gravity = slope_gravity(std::atan(steepness * mu), down);
      const auto world = make_world(settings(gravity), {floor_body(), sled_body(sleds()[0])});
      start(*world, across, gravity);
      const LinkReading before = link_of(*world, 0, 1);
      run(*world, 600);
      const Vector3d expected = coulomb(before.velocity, gravity, 0.6);
      const Vector3d way = link_of(*world, 0, 1).position - before.position;
      EXPECT_NEAR((way - expected).norm(), 0.0, 0.02 * expected.norm());
    }
}

TEST_P(IsotropicFriction, ActsBetweenTwoMovingBodies) {
  WorldBody wagon = free_box("Wagon", {1.0, 1.0, 0.2}, 20.0, {0, 0, 0.1});
  for (const int heading : headings) {
    SCOPED_TRACE(heading);
    const Vector3d ahead = heading_of(heading);
    Surface ice;
    ice.friction = 0.0;
    const WorldBody ground = with_surface(floor_body(), ice);
    const auto slip = [&](double share) {
      const auto world =
          make_world(settings(), {ground, wagon, free_box("Load", {0.2, 0.2, 0.1}, 2.0, {0, 0, 0.25 - 1e-4})});
      run(*world, 100);
      for (int i = 0; i < 300; ++i) {  // the wagon is pulled as strongly as friction carries the load along
        world->push(1, 0, share * mu * standard_gravity * 22.0 * ahead, {0, 0, 0}, Vector3d::Zero());
        EXPECT_TRUE(world->step());
      }
      return Vector3d(link_of(*world, 0, 1).position - link_of(*world, 0, 2).position + Vector3d(0, 0, 0.15));
    };
    EXPECT_LT(slip(0.98).head<2>().norm(), 5e-4);
    const Vector3d way = slip(1.02);
    EXPECT_GT(way.dot(ahead), 0.0025);  // on paper 0.0049 m
    EXPECT_NEAR(left_of(way, ahead), 0.0, 0.02 * way.norm());
  }
}

TEST_P(IsotropicFriction, StopsADiscThatSpins) {
  Surface surface;
  surface.friction = 0.0;
  surface.torsional_friction = 0.02;
  const double mass = 3.0, radius = 0.1, inertia = 0.5 * mass * radius * radius;
  const WorldBody disc = body_of(
      std::make_shared<const Model>(single_shape_model("Disc", Cylinder{radius, 0.04}, mass, {})), {0, 0, 0.02 - 1e-4});
  const auto world = make_world(settings(), {floor_body(), with_surface(disc, surface)});
  const double braking = 0.02 * mass * standard_gravity / inertia;  // [rad/s²]
  for (int i = 0; i < 100; ++i) {
    world->push(1, 0, Vector3d::Zero(), Vector3d::Zero(), {0, 0, inertia * (100.0 + braking)});
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(link_of(*world, 0, 1).angular_velocity.z(), 10.0, 0.02 * 10.0);
  run(*world, 100);
  EXPECT_NEAR(link_of(*world, 0, 1).angular_velocity.z(), 10.0 - 0.1 * braking, 0.02 * 0.1 * braking);
  run(*world, 400);
  EXPECT_NEAR(link_of(*world, 0, 1).angular_velocity.norm(), 0.0, 1e-4);
}

TEST_P(IsotropicFriction, StopsABallThatRolls) {
  Surface surface;
  surface.rolling_friction = 0.005;
  const double mass = 1.0, radius = 0.1;
  // the ball rolls without slipping: m a = -f, 2/5 m r² a/r = f r - c N
  const double braking = 5.0 / 7.0 * 0.005 * standard_gravity / radius;
  for (const int heading : headings) {
    SCOPED_TRACE(heading);
    const Vector3d ahead = heading_of(heading);
    const WorldBody ball = body_of(std::make_shared<const Model>(single_shape_model("Ball", Sphere{radius}, mass, {})),
                                   {0, 0, radius - 1e-4});
    const auto world = make_world(settings(), {floor_body(), with_surface(ball, surface)});
    for (int i = 0; i < 200; ++i) {
      world->push(1, 0, 1.5 * mass * ahead, Vector3d::Zero(), Vector3d::Zero());
      ASSERT_TRUE(world->step());
    }
    const Vector3d before = link_of(*world, 0, 1).velocity;
    run(*world, 200);
    const Vector3d measured = (before - link_of(*world, 0, 1).velocity) / 0.2;
    EXPECT_NEAR(measured.dot(ahead), braking, 0.02 * braking);
    EXPECT_NEAR(left_of(measured, ahead), 0.0, 0.02 * braking);
    run(*world, 1000);
    EXPECT_NEAR(link_of(*world, 0, 1).velocity.norm(), 0.0, 1e-4);
  }
}

TEST_P(IsotropicFriction, IsPartOfTheState) {
  const auto make = [&] {
    return make_world(settings(slope_gravity(std::atan(0.99 * mu), heading_of(30))),
                      {floor_body(), sled_body(sleds()[0])});
  };
  const auto world = make();
  run(*world, 100);
  const auto state = world->save();
  run(*world, 100);
  const auto fresh = make();
  ASSERT_TRUE(fresh->restore(state).ok());
  EXPECT_EQ(fresh->save(), state);
  run(*fresh, 100);
  EXPECT_EQ(fresh->state_hash(), world->state_hash());
  const auto other = make();
  ASSERT_TRUE(fresh->restore(state).ok());
  ASSERT_TRUE(other->take_state(*fresh).ok());
  EXPECT_EQ(other->save(), state);
  EXPECT_FALSE(fresh->restore(std::span(state).first(state.size() - 1)).ok());
  std::vector<std::byte> strange = state;
  std::fill(strange.end() - 72, strange.end(), std::byte{0x7f});  // links that don't exist
  EXPECT_FALSE(fresh->restore(strange).ok());
}

}  // namespace
}  // namespace rehearse
