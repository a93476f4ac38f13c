// Ground whose contacts use its triangles.

#include <gmock/gmock.h>

#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

WorldBody flat_ground() {
  return trimesh_body("Ground", ground_mesh(40, [](double, double) { return 0.0; }), {0.013, 0.007, 0});
}

TEST(Trimesh, CarriesEveryKindOfShape) {
  for (const Thing& thing : things()) {
    SCOPED_TRACE(thing.what);
    const auto world = make_world(
        {}, {flat_ground(), body_with("Thing", thing.geometry, thing.like, 1.0, {0, 0, thing.height + 0.001})});
    run(*world, 500);
    EXPECT_NEAR(link_of(*world, 0, 1).position.z(), thing.height, 2e-4);
    EXPECT_LT(link_of(*world, 0, 1).velocity.norm(), 1e-3);
  }
}

TEST(Trimesh, HasDents) {  // which its hull would close
  const auto dented = ground_mesh(40, [](double x, double y) { return std::hypot(x, y) < 1.0 ? -0.5 : 0.0; });
  const WorldBody ball = body_with("Ball", Sphere{0.1}, Sphere{0.1}, 1.0, {0, 0, 0.2});
  const auto open = make_world({}, {trimesh_body("Ground", dented), ball});
  run(*open, 1500);
  EXPECT_NEAR(link_of(*open, 0, 1).position.z(), -0.4, 1e-3);
  const WorldBody hull = fixed(body_with("Ground", mesh_shape(dented), Box{{1, 1, 1}}, 0.0, {0, 0, 0}));
  const auto closed = make_world({}, {hull, ball});
  run(*closed, 1500);
  EXPECT_NEAR(link_of(*closed, 0, 1).position.z(), 0.1, 1e-3);
}

TEST(Trimesh, LetsAHullSlideOverItsEdges) {
  WorldSettings settings;
  settings.solver.friction = 0.2;
  const Box box{{0.2, 0.2, 0.2}};
  const auto world =
      make_world(settings, {flat_ground(), body_with("Thing", box_mesh(box.size), box, 1.0, {0, 0, 0.1})});
  run(*world, 100);
  world->push(1, 0, {1000, 300, 0}, {0, 0, 0}, {0, 0, 0});  // 1.04 m/s: it slides v²/(2 mu g)
  run(*world, 800);
  const double expected = 1.09 / (2.0 * 0.2 * standard_gravity);
  EXPECT_NEAR(link_of(*world, 0, 1).position.head<2>().norm(), expected, 0.15 * expected);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.1, 2e-4);
}

TEST(Trimesh, StandsTrianglesWithoutArea) {  // files have them
  MeshData ground = ground_mesh(10, [](double, double) { return 0.0; });
  ground.parts[0].triangles.push_back({0, 0, 0});
  ground.parts[0].triangles.push_back({0, 1, 1});
  ground.parts[0].triangles.push_back({0, 1, 2});
  ground.parts[0].triangles.push_back(ground.parts[0].triangles[0]);
  for (const Thing& thing : things()) {
    SCOPED_TRACE(thing.what);
    const auto world = make_world({}, {trimesh_body("Ground", ground), body_with("Thing", thing.geometry, thing.like,
                                                                                 1.0, {-1.9, -1.9, thing.height})});
    run(*world, 300);
    EXPECT_GT(link_of(*world, 0, 1).position.z(), 0.05);
  }
}

TEST(Trimesh, IsForFixedBodiesOnly) {
  WorldBody moving = trimesh_body("Ground", ground_mesh(2, [](double, double) { return 0.0; }));
  moving.fixed = false;
  const auto world = World::create({}, {moving});
  ASSERT_FALSE(world.ok());
  EXPECT_THAT(to_string(world.errors()),
              HasSubstr("body 'Ground': link 'Ground' moves, and its mesh has triangles for its collision"));
}

TEST(Trimesh, IsForLinksThatNeverMoveBesideHullsOfLinksThatMove) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, 1));
  robot.add_collision(0, Mesh{std::make_shared<const MeshData>(mesh_of({box_part({1, 1, 0.2})})), nullptr});
  robot.add_collision(1, mesh_shape(mesh_of({box_part({0.2, 0.2, 0.2})})));
  const WorldBody body = body_of(robot.build());
  const auto world = make_world({}, {floor_body(), body});
  run(*world, 1000);
  EXPECT_NEAR(link_of(*world, 1, 1).position.z(), 0.1, 1e-3);  // on the floor, through its own root
}

TEST(Meshes, ThatWereNotLoadedAreRefused) {
  Model model = single_shape_model("Thing", Box{{1, 1, 1}}, 1.0, {});
  model.links[0].collisions[0].geometry = Mesh{};
  const auto world = World::create({}, {body_of(std::make_shared<const Model>(model))});
  ASSERT_FALSE(world.ok());
  EXPECT_THAT(to_string(world.errors()),
              HasSubstr("body 'Thing': link 'Thing' has a mesh for its collision that wasn't"));
}

}  // namespace
}  // namespace rehearse
