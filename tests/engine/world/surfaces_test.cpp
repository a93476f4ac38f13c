// Contact properties of links, compared with the formulas of springs, friction and bouncing.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

class Surfaces : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Surfaces, each_solver, solver_name);

WorldBody slab(const Vector3d& position = {0, 0, 0.05}) { return free_box("Slab", {0.4, 0.4, 0.1}, 2.0, position); }

Surface friction(double coefficient) {
  Surface surface;
  surface.friction = coefficient;
  return surface;
}

/// g on a slope of that angle that falls along `down` (level, unit).
WorldSettings sloping(WorldSettings settings, double slope, const Vector3d& down) {
  settings.gravity = standard_gravity * (std::sin(slope) * down - std::cos(slope) * Vector3d::UnitZ());
  return settings;
}

/// The coefficient that fits to how far the slab slid in 0.5 s; infinite if it didn't.
double measured_friction(const WorldSettings& settings, const WorldBody& floor, const WorldBody& body,
                         const Vector3d& down) {
  constexpr double slope = 0.8, time = 0.5;
  const auto world = make_world(sloping(settings, slope, down), {floor, body});
  run(*world, 500);
  const double distance = (link_of(*world, 0, 1).position - body.position).dot(down);
  if (distance < 1e-2) return std::numeric_limits<double>::infinity();
  return std::tan(slope) - 2.0 * distance / (time * time * standard_gravity * std::cos(slope));
}

TEST_P(Surfaces, FrictionIsWhatOneSideStatesAndTheSmallerOfBoth) {
  const Vector3d x = Vector3d::UnitX();
  EXPECT_TRUE(std::isinf(measured_friction(settings(), with_surface(floor_body(), friction(1.1)), slab(), x)));
  EXPECT_NEAR(measured_friction(settings(), floor_body(), with_surface(slab(), friction(0.3)), x), 0.3, 0.01);
  EXPECT_NEAR(measured_friction(settings(), with_surface(floor_body(), friction(0.3)), slab(), x), 0.3, 0.01);
  EXPECT_NEAR(
      measured_friction(settings(), with_surface(floor_body(), friction(0.3)), with_surface(slab(), friction(0.5)), x),
      0.3, 0.01);
  EXPECT_NEAR(
      measured_friction(settings(), with_surface(floor_body(), friction(0.5)), with_surface(slab(), friction(0.2)), x),
      0.2, 0.01);
}

TEST_P(Surfaces, FrictionCanBeOtherInADirectionOfTheLink) {
  Surface skate = friction(0.1);  // along its x
  skate.second_friction = 0.9;
  skate.friction_direction = Vector3d::UnitX();
  WorldBody body = with_surface(slab(), skate);
  EXPECT_NEAR(measured_friction(settings(), floor_body(), body, Vector3d::UnitX()), 0.1, 0.01);
  EXPECT_NEAR(measured_friction(settings(), floor_body(), body, Vector3d::UnitY()), 0.9, 0.03);
  body.rotation = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ());
  EXPECT_NEAR(measured_friction(settings(), floor_body(), body, Vector3d::UnitX()), 0.9, 0.03);
  EXPECT_NEAR(measured_friction(settings(), floor_body(), body, Vector3d::UnitY()), 0.1, 0.01);
  EXPECT_NEAR(measured_friction(settings(), with_surface(floor_body(), friction(0.4)), body, Vector3d::UnitX()), 0.4,
              0.01);
}

TEST_P(Surfaces, SpringsGiveByTheWeight) {
  Surface soft;
  soft.stiffness = 1e4;
  soft.damping = 100.0;
  const double sunk = 2.0 * standard_gravity / (4.0 * 1e4);  // four points carry it
  const double layer = settings().solver.surface_layer;
  for (const bool both : {false, true}) {
    const auto world =
        make_world(settings(), {both ? with_surface(floor_body(), soft) : floor_body(), with_surface(slab(), soft)});
    run(*world, 2000);
    // two springs, one behind the other, give twice as much
    EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.05 - layer - (both ? 2.0 : 1.0) * sunk, 0.02 * sunk);
  }
}

TEST_P(Surfaces, SpringsSwingWithTheirPeriod) {
  Surface spring;
  spring.stiffness = 2000.0;
  spring.damping = 0.0;
  WorldBody body = with_surface(slab({0, 0, 0.04}), spring);
  const auto world = make_world(settings(), {floor_body(), body});
  const double period = 2.0 * M_PI * std::sqrt(2.0 / (4.0 * 2000.0));
  // pushed in 10 mm: it is thrown up, and off after less than half a period
  run(*world, static_cast<int>(1000 * period / 4));
  const double speed = (0.01 - 2.0 * standard_gravity / 8000.0) * 2.0 * M_PI / period;
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.z(), speed, 0.1 * speed);
}

TEST_P(Surfaces, LimitTheVelocityThatPushesApart) {
  Surface brisk;
  brisk.max_velocity = 0.05;
  const auto world = make_world(settings(), {floor_body(), with_surface(slab({0, 0, 0.04}), brisk),
                                             free_box("Other", {0.4, 0.4, 0.1}, 2.0, {2, 0, 0.04})});
  run(*world, 100);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.045, 1e-4);
  EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.041, 1e-4);  // the others keep the solver's
}

TEST_P(Surfaces, ArePushedApartDownToTheirDepth) {
  Surface deep;
  deep.min_depth = 0.002;
  const auto world = make_world(settings(), {floor_body(), with_surface(slab({0, 0, 0.045}), deep),
                                             free_box("Other", {0.4, 0.4, 0.1}, 2.0, {2, 0, 0.045})});
  run(*world, 1500);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.048, 2e-4);
  EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.05, 2e-4);
}

TEST_P(Surfaces, BounceWithTheirRestitution) {
  Surface rubber;
  rubber.restitution = 0.6;
  const auto model = std::make_shared<const Model>(single_shape_model("Ball", Sphere{0.1}, 1.0, {}));
  const auto world = make_world(settings(), {floor_body(), with_surface(body_of(model, {0, 0, 1.1}), rubber)});
  double top = 0.0;
  bool bounced = false;
  for (int i = 0; i < 800; ++i) {
    ASSERT_TRUE(world->step());
    bounced |= link_of(*world, 0, 1).velocity.z() > 0.1;
    if (bounced) top = std::max(top, link_of(*world, 0, 1).position.z() - 0.1);
  }
  EXPECT_NEAR(top, 0.36, 0.01);  // 1 m times the square
}

TEST(SurfacesThatMakeNoSense, AreRefused) {
  const auto refusal = [](const Surface& surface) {
    const auto world = World::create({}, {with_surface(slab(), surface)});
    return world ? std::string() : to_string(world.errors());
  };
  Surface surface;
  surface.friction = -0.1;
  EXPECT_THAT(refusal(surface), HasSubstr("body 'Slab': the friction of link 'Slab' is out of its range"));
  surface = {};
  surface.stiffness = 0.0;
  EXPECT_THAT(refusal(surface), HasSubstr("contact stiffness"));
  surface = {};
  surface.damping = std::nan("");
  EXPECT_THAT(refusal(surface), HasSubstr("contact damping"));
  surface = {};
  surface.restitution = 1.5;
  EXPECT_THAT(refusal(surface), HasSubstr("restitution"));
  surface = {};
  surface.friction_direction = Vector3d::Zero();
  EXPECT_THAT(refusal(surface), HasSubstr("direction of friction"));
  surface = friction(std::numeric_limits<double>::infinity());
  EXPECT_EQ(refusal(surface), "");
}

}  // namespace
}  // namespace rehearse
