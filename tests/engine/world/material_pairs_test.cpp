// Friction and restitution that are stated for two materials.

#include "robots.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using Eigen::Vector3d;

class MaterialPairs : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, MaterialPairs, each_solver, solver_name);

WorldBody of_material(WorldBody body, const std::string& material) {
  body.materials.assign(body.model->links.size(), material);
  return body;
}

/// The distance that a block slides on the floor with 1 m/s at the beginning [m].
double slide(WorldSettings settings, const std::string& block, const std::string& floor) {
  settings.pairs = {{{"ice", "wood"}, 0.1, {}}, {{"wood", "wood"}, 0.4, {}}};
  WorldBody sliding = of_material(free_box("Block", {0.2, 0.2, 0.1}, 1.0, {0, 0, 0.0499}), block);
  sliding.linear_velocity = {1, 0, 0};
  const auto world = make_world(settings, {of_material(floor_body(), floor), sliding});
  run(*world, 1500);
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.x(), 0.0, 1e-3);
  return link_of(*world, 0, 1).position.x();
}

TEST_P(MaterialPairs, GiveTheFrictionOfTwoMaterials) {
  const auto paper = [](double mu) { return 1.0 / (2.0 * mu * standard_gravity); };  // v² / (2 mu g)
  EXPECT_NEAR(slide(settings(), "ice", "wood"), paper(0.1), 0.01 * paper(0.1));
  EXPECT_NEAR(slide(settings(), "wood", "ice"), paper(0.1), 0.01 * paper(0.1));
  EXPECT_NEAR(slide(settings(), "wood", "wood"), paper(0.4), 0.01 * paper(0.4));
  EXPECT_NEAR(slide(settings(), "ice", "ice"), paper(1.0), 0.02 * paper(1.0)) << "the solver's";
}

TEST_P(MaterialPairs, GiveTheRestitutionOfTwoMaterials) {
  WorldSettings springy = settings();
  springy.pairs = {{{"rubber", "wood"}, {}, 0.8}};
  RobotBuilder ball(JointType::free, solid_inertial(Sphere{0.1}, 0.5));
  ball.add_collision(0, Sphere{0.1});
  const auto world = make_world(
      springy, {of_material(floor_body(), "wood"), of_material(body_of(ball.build(), {0, 0, 1.1}), "rubber")});
  double highest = 0.0;
  for (int tick = 0; tick < 1200; ++tick) {
    ASSERT_TRUE(world->step());
    if (tick > 500) highest = std::max(highest, link_of(*world, 0, 1).position.z());  // it lands after 0.45 s
  }
  EXPECT_NEAR(highest, 0.1 + 0.64, 0.01);  // 0.8² of the height of 1 m
}

TEST(MaterialPairsOfAWorld, NeedAMaterialForEachLinkOrNone) {
  WorldBody body = free_box("Block", {1, 1, 1}, 1.0, {0, 0, 0});
  body.materials = {"wood", "ice"};
  const auto world = World::create({}, {body});
  ASSERT_FALSE(world);
  EXPECT_THAT(to_string(world.errors()), testing::HasSubstr("has 1 links, but 2 materials were given"));
}

}  // namespace
}  // namespace rehearse
