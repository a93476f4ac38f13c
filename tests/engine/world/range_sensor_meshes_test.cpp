// Intersections of beams with meshes: with their hulls, and with their triangles.

#include <cmath>
#include <limits>

#include "mesh/heightmap_file.h"
#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr float nothing = std::numeric_limits<float>::infinity();

/// A fixed body without shapes, whose beams go all around: the first row level, straight ahead along the world's +x.
WorldBody eye(const RangeSensor& sensor) {
  RobotBuilder robot(JointType::fixed);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  robot.add_device("Laser", 0, sensor, pose);
  WorldBody body = body_of(robot.build());
  body.name = "Eye";
  return body;
}

RangeSensor all_around() {
  RangeSensor sensor;
  sensor.yaw = {-3.0, 3.0, 121};
  sensor.pitch = {-1.4, 1.4, 15};
  return sensor;
}

std::vector<float> measure(const RangeSensor& sensor, std::vector<WorldBody> things) {
  things.insert(things.begin(), eye(sensor));
  return make_world({}, std::move(things))->measure_ranges(0, 0);
}

std::vector<Vector3d> beams(const RangeSensor& sensor) {
  std::vector<Vector3d> directions;
  for (const Vector3d& beam : beam_directions(sensor)) directions.push_back({-beam.z(), -beam.x(), beam.y()});
  return directions;
}

/// Distance along a beam from the origin to the nearest triangle, by Cramer's rule (T. Moeller and B. Trumbore, 1997).
double to_triangles(const MeshData& mesh, const Vector3d& place, const Vector3d& beam) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const MeshPart& part : mesh.parts) {
    for (const auto& triangle : part.triangles) {
      const Vector3d a = place + part.vertices[triangle[0]].cast<double>();
      const Vector3d b = place + part.vertices[triangle[1]].cast<double>();
      const Vector3d c = place + part.vertices[triangle[2]].cast<double>();
      Eigen::Matrix3d m;
      m << b - a, c - a, -beam;
      if (m.determinant() == 0.0) continue;
      const Vector3d solution = m.inverse() * -a;
      if (solution.x() >= 0.0 && solution.y() >= 0.0 && solution.x() + solution.y() <= 1.0 && solution.z() > 0.1)
        nearest = std::min(nearest, solution.z());
    }
  }
  return nearest;
}

/// All beams within 1 mm + 0.1 % of casting them at triangles; but for those that pass an outline within rounding.
void expect_ranges(const WorldBody& body, const MeshData& mesh, int least_hits) {
  const RangeSensor sensor = all_around();
  const std::vector<float> ranges = measure(sensor, {body});
  const std::vector<Vector3d> directions = beams(sensor);
  int hits = 0, outlines = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double expected = to_triangles(mesh, body.position, directions[i]);
    if (std::isinf(ranges[i]) != (expected > sensor.max_distance)) {
      ++outlines;
    } else if (ranges[i] != nothing) {
      ++hits;
      EXPECT_NEAR(ranges[i], expected, 0.001 + 0.001 * expected) << "beam " << i;
    }
  }
  EXPECT_GE(hits, least_hits);
  EXPECT_LE(outlines, 2);
}

TEST(RangeSensorsAtMeshes, MeasureHulls) {
  for (const Vector3d& place : {Vector3d(2.0, 0.3, 0.2), Vector3d(-1.5, -1.0, 0.5), Vector3d(-2.0, 0.1, 0.0)}) {
    const MeshData ball = mesh_of({globe_part(0.7, 11, 9)});
    expect_ranges(fixed(body_with("Ball", mesh_shape(ball), Sphere{0.7}, 0.0, place)), ball, 20);
  }
}

TEST(RangeSensorsAtMeshes, MeasureBoxesOfTriangles) {
  const MeshData box = mesh_of({box_part({1.0, 0.6, 0.8})});
  expect_ranges(fixed(body_with("Box", mesh_shape(box), Box{{1, 1, 1}}, 0.0, {-1.5, 0.4, 0.1})), box, 20);
}

TEST(RangeSensorsAtMeshes, MeasureTheTrianglesThemselves) {
  const MeshData hills = ground_mesh(40, [](double x, double y) { return 0.3 * std::sin(2 * x) * std::cos(3 * y); });
  expect_ranges(trimesh_body("Hills", hills, {0, 0, -0.8}), hills, 400);
}

TEST(RangeSensorsAtMeshes, MeasureAHeightmap) {
  std::string grid;
  for (int row = 0; row < 31; ++row, grid += "\n")
    for (int column = 0; column < 37; ++column)
      grid += std::to_string(0.3 * std::sin(0.25 * column) * std::cos(0.4 * row)) + " ";
  const auto hills = read_heightmap(grid, "hills.txt", {{4.0, 3.0}});
  ASSERT_TRUE(hills.ok());
  WorldBody body = fixed(body_with("Hills", *hills, Box{{1, 1, 1}}, 0.0, {0.1, 0.2, -0.8}));
  expect_ranges(body, *hills->data, 400);
  body.position.z() = 0.5;  // seen from below
  expect_ranges(body, *hills->data, 400);
}

TEST(RangeSensorsAtMeshes, SeeTheNearestTriangleOfMany) {
  std::vector<MeshPart> plates;  // the farther ones first, and in between
  for (const double x : {3.0, 1.0, 4.0, 2.0}) plates.push_back(box_part({0.1, 1.0, 1.0}, {x, 0, 0}));
  RangeSensor pointer;
  EXPECT_NEAR(measure(pointer, {trimesh_body("Plates", mesh_of(plates))})[0], 0.95, 1e-6);
}

TEST(RangeSensorsAtMeshes, LookOutOfAHullButSeeTheWallsOfARoom) {
  const MeshData room = mesh_of({box_part({4.0, 4.0, 2.0})});
  RangeSensor pointer;
  EXPECT_EQ(measure(pointer, {fixed(body_with("Room", mesh_shape(room), Box{{1, 1, 1}}, 0.0, {0, 0, 0}))})[0], nothing);
  EXPECT_NEAR(measure(pointer, {trimesh_body("Room", room)})[0], 2.0, 1e-6);
}

TEST(RangeSensorsAtMeshes, SeeNothingOfAHullBeyondTheirMaximum) {
  const Mesh plate = mesh_shape(mesh_of({box_part({0.1, 1.0, 1.0})}));
  RangeSensor pointer;
  pointer.max_distance = 2.0;
  const auto at_distance = [&](double x) {
    return measure(pointer, {fixed(body_with("Plate", plate, Box{{1, 1, 1}}, 0.0, {x, 0, 0}))})[0];
  };
  EXPECT_NEAR(at_distance(2.0499), 1.9999, 1e-6);
  EXPECT_EQ(at_distance(2.0501), nothing);
}

}  // namespace
}  // namespace rehearse
