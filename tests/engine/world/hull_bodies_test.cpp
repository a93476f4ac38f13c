// Bodies whose shapes are meshes: they rest, slide and roll like the simple shapes that they approximate.

#include <cmath>

#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

WorldBody cube(const Vector3d& position, double edge = 0.2) {
  const Box box{Vector3d::Constant(edge)};
  return body_with("Cube", box_mesh(box.size), box, 2.0, position);
}

Eigen::Quaterniond lying() { return Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX())); }

class HullBodies : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, HullBodies, each_solver, solver_name);

double tilt_of(const LinkReading& link) { return std::acos(std::min(1.0, (link.rotation * Vector3d::UnitZ()).z())); }

/// Checks that after 2 s the body is at its height, level, and at rest.
void expect_rest(const World& world, int body, double height, double tilt) {
  const LinkReading& link = link_of(world, 0, body);
  EXPECT_NEAR(link.position.z(), height, 2e-4);
  EXPECT_NEAR(tilt_of(link), 0.0, tilt);
  EXPECT_LT(link.velocity.norm(), 1e-4);
  EXPECT_LT(link.angular_velocity.norm(), 1e-3);
  EXPECT_NEAR(link.position.head<2>().norm(), 0.0, 1e-4);
}

TEST_P(HullBodies, ACubeRestsLevelOnBoxesHullsAndCylinders) {
  const Box table{{1.0, 1.0, 0.2}};
  const Cylinder drum{0.4, 0.2};
  const std::pair<const char*, Geometry> supports[] = {
      {"box", table}, {"hull", box_mesh(table.size)}, {"cylinder", drum}};
  for (const auto& [what, support] : supports) {
    SCOPED_TRACE(what);
    const auto world =
        make_world(settings(), {fixed(body_with("Support", support, table, 0.0, {0, 0, -0.1})), cube({0, 0, 0.101})});
    run(*world, 2000);
    expect_rest(*world, 1, 0.1, 1e-4);
  }
}

TEST_P(HullBodies, ABoxRestsOnAHullAsOnABox) {
  const auto world =
      make_world(settings(), {fixed(body_with("Table", box_mesh({1, 1, 0.2}), Box{{1, 1, 0.2}}, 0.0, {0, 0, -0.1})),
                              free_box("Box", {0.2, 0.2, 0.2}, 2.0, {0, 0, 0.101})});
  run(*world, 2000);
  expect_rest(*world, 1, 0.1, 1e-4);
}

TEST_P(HullBodies, SpheresCapsulesAndCylindersRestOnAHull) {
  struct Case {
    const char* what;
    Geometry geometry;
    bool lies;
    double height;
  };
  const Case cases[] = {{"sphere", Sphere{0.1}, false, 0.1},
                        {"lying capsule", Capsule{0.1, 0.3}, true, 0.1},
                        {"lying cylinder", Cylinder{0.1, 0.3}, true, 0.1},
                        {"standing cylinder", Cylinder{0.1, 0.3}, false, 0.15},
                        {"standing capsule", Capsule{0.1, 0.3}, false, 0.25}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.what);
    WorldBody thing = body_with("Thing", each.geometry, each.geometry, 1.0, {0, 0, each.height + 0.001});
    if (each.lies) thing.rotation = lying();
    const auto world = make_world(
        settings(), {fixed(body_with("Table", box_mesh({1, 1, 0.2}), Box{{1, 1, 0.2}}, 0.0, {0, 0, -0.1})), thing});
    run(*world, 500);
    const LinkReading& link = link_of(*world, 0, 1);
    EXPECT_NEAR(link.position.z(), each.height, 3e-4);
    EXPECT_LT(link.velocity.norm(), 1e-2);
  }
}

TEST_P(HullBodies, ACubeSlidesBeyondTheFrictionConeOnly) {
  for (const double slope : {0.3, 0.9}) {  // the friction coefficient is tan(0.54)
    WorldSettings tilted = settings();
    tilted.solver.friction = 0.6;
    tilted.gravity = standard_gravity * Vector3d(std::sin(slope), 0, -std::cos(slope));
    const Box slab{{0.4, 0.4, 0.1}};
    const auto world =
        make_world(tilted, {floor_body(), body_with("Slab", box_mesh(slab.size), slab, 2.0, {0, 0, 0.05})});
    run(*world, 500);
    const double time = 0.5;
    if (slope < 0.54) {
      EXPECT_NEAR(link_of(*world, 0, 1).position.x(), 0.0, 1e-2);
    } else {
      const double expected = 0.5 * standard_gravity * (std::sin(slope) - 0.6 * std::cos(slope)) * time * time;
      EXPECT_NEAR(link_of(*world, 0, 1).position.x(), expected, 0.03 * expected);
    }
  }
}

TEST_P(HullBodies, WhatTumblesStaysAboveTheFloorAndComesToRest) {
  WorldBody thrown = cube({0, 0, 0.5});
  thrown.rotation = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 0.5).normalized());
  const auto world = make_world(settings(), {floor_body(), thrown});
  world->push(1, 0, {800, 200, 0}, {0, 0.05, 0.05}, {0, 0, 0});
  for (int i = 0; i < 4000; ++i) {
    ASSERT_TRUE(world->step());
    ASSERT_GT(link_of(*world, 0, 1).position.z(), 0.095);
  }
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.1, 3e-4);
  EXPECT_LT(link_of(*world, 0, 1).velocity.norm(), 1e-2);
}

TEST_P(HullBodies, APileOfStonesComesToRest) {
  std::vector<WorldBody> bodies{floor_body()};
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(body_with("Stone" + std::to_string(i), mesh_shape(mesh_of({globe_part(0.1, 5 + i, 3)})),
                               Sphere{0.1}, 1.0, {0.03 * i, 0.02 * (i % 3), 0.15 + 0.22 * i}));
  }
  const auto world = make_world(settings(), bodies);
  run(*world, 8000);
  for (int i = 1; i <= 6; ++i) {
    EXPECT_GT(link_of(*world, 0, i).position.z(), 0.03);
    EXPECT_LT(link_of(*world, 0, i).velocity.norm(), 0.1);
  }
}

TEST_P(HullBodies, AHullOfManySidesRollsLikeTheCylinderThatItIs) {
  // down a slope of 0.1 without slipping: g sin(slope) * 2/3. 64 corners are a polygon still.
  std::vector<Vector3d> rim;
  Triangles triangles;
  for (std::uint32_t i = 0; i < 64; ++i) {
    for (const double y : {-0.1, 0.1})
      rim.push_back({0.2 * std::sin(2 * M_PI * i / 64), y, 0.2 * std::cos(2 * M_PI * i / 64)});
    triangles.push_back({2 * i, 2 * i + 1, (2 * i + 2) % 128});
  }
  WorldSettings tilted = settings();
  tilted.gravity = standard_gravity * Vector3d(std::sin(0.1), 0, -std::cos(0.1));
  const Mesh wheel = mesh_shape(mesh_of({part_of(rim, triangles)}));
  EXPECT_EQ(wheel.hulls->at(0).vertices.size(), 128u);
  Model model = single_shape_model("Wheel", Sphere{0.1}, 1.0, {});
  model.links[0].inertial.inertia = Vector3d(0.0133, 0.02, 0.0133).asDiagonal();  // 1/2 m r² about y
  model.links[0].collisions[0].geometry = wheel;
  const auto world =
      make_world(tilted, {floor_body(), body_of(std::make_shared<const Model>(std::move(model)), {0, 0, 0.2})});
  world->push(1, 0, {600, 0, 0}, {0, 0, 0}, {0, 120, 0});  // 0.6 m/s to begin with
  run(*world, 1000);
  const double expected = 0.6 + standard_gravity * std::sin(0.1) * 2.0 / 3.0;
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.x(), expected, 0.1 * expected);
}

TEST_P(HullBodies, TwoRunsGiveTheSameBits) {
  const auto hash = [this] {
    std::vector<WorldBody> bodies{floor_body(), cube({0, 0, 0.3}), cube({0.05, 0.03, 0.6}), cube({0.02, 0.06, 0.9})};
    const auto world = make_world(settings(), bodies);
    run(*world, 1000);
    return world->state_hash();
  };
  EXPECT_EQ(hash(), hash());
}

}  // namespace
}  // namespace rehearse
