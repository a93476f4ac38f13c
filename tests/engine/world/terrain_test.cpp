// Ground of a heightmap, and stairs of triangles: against mechanics on paper, and beams against their true surface.

#include <gmock/gmock.h>

#include <functional>

#include "mesh/heightmap_file.h"
#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using Height = std::function<double(double x, double y)>;

constexpr double side = 4.0;  // of the ground [m]

/// The ground of a grid in text, as in a file.
Mesh ground(int points, const Height& height) {
  std::string text;
  for (int row = 0; row < points; ++row) {
    for (int column = 0; column < points; ++column)
      text +=
          std::to_string(height(side * column / (points - 1) - side / 2, side / 2 - side * row / (points - 1))) + " ";
    text += "\n";
  }
  auto mesh = read_heightmap(text, "ground.txt", {{side, side}});
  EXPECT_TRUE(mesh.ok()) << to_string(mesh.errors());
  return *std::move(mesh);
}

WorldBody ground_body(const Mesh& ground, const Vector3d& position = Vector3d::Zero()) {
  return fixed(body_with("Ground", ground, Box{{1, 1, 1}}, 0.0, position));
}

WorldBody ground_body(int points, const Height& height) { return ground_body(ground(points, height)); }

TEST(Terrain, CarriesEveryKindOfShape) {
  for (const Thing& thing : things()) {
    SCOPED_TRACE(thing.what);
    const auto world = make_world(
        {}, {ground_body(33, [](double, double) { return 0.3; }),
             body_with("Thing", thing.geometry, thing.like, 1.0, {0.013, 0.007, 0.3 + thing.height + 0.001})});
    run(*world, 500);
    EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.3 + thing.height, 2e-4);
    EXPECT_LT(link_of(*world, 0, 1).velocity.norm(), 1e-3);
  }
}

TEST(Terrain, LetsABallRollDownASlopeAsAPlane) {  // 5/7 g sin(slope)
  constexpr double radius = 0.1, slope = 0.2, time = 1.0;
  for (const double heading : {0.0, 0.5, 1.9, 3.5, 5.1}) {
    const Vector3d down(std::cos(heading), std::sin(heading), 0.0);
    const WorldBody ground =
        ground_body(41, [&](double x, double y) { return -std::tan(slope) * (x * down.x() + y * down.y()); });
    const Vector3d normal = std::sin(slope) * down + std::cos(slope) * Vector3d::UnitZ();
    const auto world =
        make_world({}, {ground, body_with("Ball", Sphere{radius}, Sphere{radius}, 1.0, radius * normal)});
    run(*world, 1000);
    const Vector3d moved = link_of(*world, 0, 1).position - radius * normal;
    const Vector3d along = std::cos(slope) * down - std::sin(slope) * Vector3d::UnitZ();
    const double expected = 0.5 * 5.0 / 7.0 * standard_gravity * std::sin(slope) * time * time;
    EXPECT_NEAR(moved.dot(along), expected, 0.005 * expected) << heading;
    EXPECT_NEAR((moved - moved.dot(along) * along).norm(), 0.0, 2e-3) << heading;  // straight down, on the ground
  }
}

TEST(Terrain, HoldsABoxOnASlopeUpToItsFriction) {
  WorldSettings settings;
  settings.solver.friction = 0.5;
  const Box box{{0.4, 0.3, 0.1}};
  for (const double share : {0.97, 1.03}) {
    const double slope = std::atan(share * 0.5);
    WorldBody thing = body_with("Box", box, box, 1.0, 0.05 * Vector3d(std::sin(slope), 0, std::cos(slope)));
    thing.rotation = Eigen::AngleAxisd(slope, Vector3d::UnitY());
    const auto world =
        make_world(settings, {ground_body(41, [&](double x, double) { return -std::tan(slope) * x; }), thing});
    run(*world, 1000);
    const double moved = (link_of(*world, 0, 1).position - thing.position).norm();
    if (share < 1.0)
      EXPECT_LT(moved, 2e-3);
    else
      EXPECT_NEAR(moved, 0.5 * standard_gravity * (std::sin(slope) - 0.5 * std::cos(slope)), 0.02);
  }
}

TEST(Terrain, CarriesABoxOnAPeakUnderItsMiddle) {
  const auto peak = [](double x, double y) { return std::max(0.0, 0.3 - 3.0 * std::hypot(x, y)); };
  const Box box{{0.6, 0.6, 0.1}};
  for (const Geometry& shape : {Geometry(box), Geometry(box_mesh(box.size)), Geometry(Cylinder{0.3, 0.1})}) {
    const auto world = make_world({}, {ground_body(41, peak), body_with("Plate", shape, box, 1.0, {0, 0, 0.351})});
    run(*world, 200);
    EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.35, 2e-3) << shape.index();
  }
}

TEST(Terrain, HasTheSameSurfaceForContactsAndBeams) {     // each cell is cut from small x and y to large x and y
  const double corners[2][2] = {{0.0, 0.4}, {0.1, 0.0}};  // by x and y
  const Mesh cell = ground(2, [&](double x, double y) { return corners[x > 0][y > 0]; });
  RobotBuilder robot(JointType::fixed);
  robot.add_device("Down", 0, RangeSensor{});
  WorldBody eye = body_of(robot.build(), {0.3, 0.3, 2.0});
  eye.name = "Eye";
  const auto world = make_world({}, {eye, ground_body(cell)});
  EXPECT_NEAR(world->measure_ranges(0, 0)[0], 2.0, 1e-6);  // on the diagonal between two corners of height 0
  const auto rest =
      make_world({}, {ground_body(cell), body_with("Ball", Sphere{0.05}, Sphere{0.05}, 1.0, {0.3, 0.3, 0.06})});
  run(*rest, 20);
  EXPECT_LT(link_of(*rest, 0, 1).position.z(), 0.06);
  EXPECT_GT(link_of(*rest, 0, 1).position.z(), 0.049);
}

/// A flight of stairs that rise along x from 0: a surface, without an inside.
MeshData stairs(int steps, double rise, double tread) {
  std::vector<Vector3d> vertices;
  Triangles triangles;
  for (int i = 0; i < 2 * steps; ++i)
    for (const double y : {-1.0, 1.0}) vertices.push_back({tread * (i / 2), y, rise * ((i + 1) / 2)});
  for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 2) {
    triangles.push_back({i, i + 2, i + 1});
    triangles.push_back({i + 1, i + 2, i + 3});
  }
  return mesh_of({part_of(vertices, std::move(triangles))});
}

TEST(Terrain, CarriesABoxOnEachStepOfStairs) {
  constexpr double rise = 0.17, tread = 0.3;
  const Box box{{0.2, 0.2, 0.1}};
  for (const Geometry& shape : {Geometry(box), Geometry(box_mesh(box.size))}) {
    std::vector<WorldBody> bodies{trimesh_body("Stairs", stairs(6, rise, tread))};
    for (int step = 0; step < 5; ++step)
      bodies.push_back(body_with("Box" + std::to_string(step), shape, box, 1.0,
                                 {tread * (step + 0.5), 0.1, rise * (step + 1) + 0.06}));
    const auto world = make_world({}, bodies);
    run(*world, 1000);
    for (int step = 0; step < 5; ++step) {
      const LinkReading box_link = link_of(*world, 0, 1 + step);
      EXPECT_NEAR(box_link.position.z(), rise * (step + 1) + 0.05, 5e-4) << step;
      EXPECT_NEAR(box_link.position.x(), tread * (step + 0.5), 2e-3) << step;
      EXPECT_LT(box_link.velocity.norm(), 1e-2) << step;
    }
  }
}

TEST(Terrain, GivesTheSameBitsInEveryRunAndAfterARestore) {
  const auto hills = [](double x, double y) { return 0.2 * std::sin(2.0 * x) * std::cos(3.0 * y); };
  const auto make = [&] {
    std::vector<WorldBody> bodies{ground_body(81, hills)};
    for (const Thing& thing : things())
      bodies.push_back(body_with(thing.what, thing.geometry, thing.like, 1.0,
                                 {0.4 * static_cast<double>(bodies.size()) - 1.2, 0.3, 0.6}));
    return make_world({}, bodies);
  };
  const auto one = make(), two = make();
  run(*one, 400);
  run(*two, 200);
  const auto state = two->save();
  run(*two, 200);
  EXPECT_EQ(one->state_hash(), two->state_hash());
  ASSERT_TRUE(two->restore(state).ok());
  run(*two, 200);
  EXPECT_EQ(one->state_hash(), two->state_hash());
}

}  // namespace
}  // namespace rehearse
