// Convex hulls of meshes for contacts.

#include "mesh/convex_hull.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "../meshes.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

ConvexHulls hulls_of(const MeshData& mesh) {
  auto hulls = convex_hulls(mesh);
  if (hulls) return std::move(*hulls);
  ADD_FAILURE() << to_string(hulls.errors());
  return {};
}

/// Signed distance of a point from a face's plane, outside positive [m].
double above(const ConvexHull& hull, const std::vector<int>& face, const Vector3d& point) {
  Vector3d normal = Vector3d::Zero();  // Newell's
  for (std::size_t i = 0; i < face.size(); ++i)
    normal += hull.vertices[face[i]].cross(hull.vertices[face[(i + 1) % face.size()]]);
  return normal.normalized().dot(point - hull.vertices[face[0]]);
}

/// Checks that a hull is closed, faces outwards, has flat faces, and has Euler's number of a ball.
void expect_sound(const ConvexHull& hull, double flatness) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& face : hull.faces) {
    ASSERT_GE(face.size(), 3u);
    for (std::size_t i = 0; i < face.size(); ++i) ++edges[{face[i], face[(i + 1) % face.size()]}];
    for (const Vector3d& vertex : hull.vertices) EXPECT_LE(above(hull, face, vertex), flatness);
    for (const int vertex : face) EXPECT_GE(above(hull, face, hull.vertices[vertex]), -flatness);
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), edges.size() / 2 + 2);
}

TEST(ConvexHull, OfABoxHasEightVerticesAndSixSquares) {
  const ConvexHulls made = hulls_of(mesh_of({box_part({0.2, 0.4, 0.6}, {1, 2, 3})}));
  ASSERT_EQ(made.hulls.size(), 1u);
  EXPECT_TRUE(made.remarks.empty());
  const ConvexHull& hull = made.hulls[0];
  EXPECT_EQ(hull.vertices.size(), 8u);
  ASSERT_EQ(hull.faces.size(), 6u);
  for (const auto& face : hull.faces) EXPECT_EQ(face.size(), 4u);
  expect_sound(hull, 1e-6);
}

TEST(ConvexHull, StatesTheVolumeOfAllItsPoints) {
  MeshPart ball = globe_part(0.3, 24, 16);
  std::vector<Vector3d> points;
  for (const Eigen::Vector3f& vertex : ball.vertices) points.push_back(vertex.cast<double>());
  std::map<int, double> volumes;
  const auto hulls = convex_hulls(mesh_of({std::move(ball)}), &volumes);
  ASSERT_TRUE(hulls.ok());
  EXPECT_LT(volume(hulls->hulls[0]), volumes.at(0)) << "it is thinned";
  EXPECT_EQ(volumes.at(0), hull_volume(points));
}

TEST(ConvexHull, TakesFloatsAsTheyAre) {
  const ConvexHulls made = hulls_of(mesh_of({box_part({0.1, 0.1, 0.1})}));
  for (const Vector3d& vertex : made.hulls[0].vertices)
    EXPECT_EQ(vertex.cwiseAbs(), Vector3d::Constant(static_cast<double>(0.05f)));
}

TEST(ConvexHull, LeavesOutWhatIsInsideAndWhatLiesInAFace) {
  // a box with a dent, whose sides are cut into a fine grid with roundings of floats: turned, so that they show
  std::vector<Vector3d> points;
  const Eigen::AngleAxisd turn(0.3, Vector3d(1, 2, 3).normalized());
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 20; ++j)
      for (const double z : {0.0, 0.37}) points.push_back(turn * Vector3d(0.05 * i, 0.05 * j, z));
  points.push_back(turn * Vector3d(0.5, 0.5, 0.1));
  Triangles triangles;
  for (std::uint32_t i = 0; i + 2 < points.size(); ++i) triangles.push_back({i, i + 1, i + 2});
  const ConvexHulls made = hulls_of(mesh_of({part_of(points, triangles)}));
  EXPECT_TRUE(made.remarks.empty());
  EXPECT_EQ(made.hulls[0].vertices.size(), 8u);
  EXPECT_EQ(made.hulls[0].faces.size(), 6u);
  expect_sound(made.hulls[0], 2e-6);
}

TEST(ConvexHull, IsMadeOfEachObjectOfAFile) {
  const MeshData mesh = mesh_of(
      {box_part({1, 1, 1}, {0, 0, 0}, 0), box_part({1, 1, 1}, {5, 0, 0}, 3), box_part({1, 1, 1}, {5, 0, 1}, 3)});
  const ConvexHulls made = hulls_of(mesh);
  ASSERT_EQ(made.hulls.size(), 2u);
  for (const Vector3d& vertex : made.hulls[1].vertices) EXPECT_GE(vertex.x(), 4.5);
  EXPECT_EQ(made.hulls[1].vertices.size(), 8u);  // two boxes, one on the other: one block
  expect_sound(made.hulls[1], 1e-6);
}

TEST(ConvexHull, DoesNotDependOnTheOrderOfTrianglesAndVertices) {
  MeshPart part = globe_part(0.5, 12, 9);
  const ConvexHull first = hulls_of(mesh_of({part})).hulls[0];
  std::ranges::reverse(part.triangles);
  std::ranges::reverse(part.vertices);
  for (auto& triangle : part.triangles)
    for (auto& vertex : triangle) vertex = static_cast<std::uint32_t>(part.vertices.size()) - 1 - vertex;
  const ConvexHull second = hulls_of(mesh_of({part})).hulls[0];
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.faces, second.faces);
}

TEST(ConvexHull, OfManyVerticesIsThinnedAndSaysHowFar) {
  const ConvexHulls made = hulls_of(mesh_of({globe_part(0.1, 64, 32, {3, 0, 0})}));
  const ConvexHull& hull = made.hulls[0];
  EXPECT_EQ(hull.vertices.size(), max_hull_vertices);
  expect_sound(hull, 1e-6);
  double deepest = 0.0;  // of the sphere's surface under its faces
  for (const Vector3d& vertex : hull.vertices) EXPECT_LE((vertex - Vector3d(3, 0, 0)).norm(), 0.1 + 1e-6);
  for (const auto& face : hull.faces) deepest = std::max(deepest, 0.1 + above(hull, face, {3, 0, 0}));
  EXPECT_LT(deepest, 0.04 * 0.1);
  ASSERT_EQ(made.remarks.size(), 1u);
  EXPECT_EQ(made.remarks[0].severity, Severity::note);
  EXPECT_THAT(made.remarks[0].message, ::testing::ContainsRegex("^it has a hull of [0-9]+ vertices: "
                                                                "contact takes 128 of them"));
}

TEST(ConvexHull, OfASheetIsAMillimetreThick) {
  const std::vector<Vector3d> corners{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const ConvexHulls made = hulls_of(mesh_of({part_of(corners, {{0, 1, 2}, {0, 2, 3}})}));
  const ConvexHull& hull = made.hulls[0];
  EXPECT_EQ(hull.vertices.size(), 8u);
  for (const Vector3d& vertex : hull.vertices) EXPECT_NEAR(std::abs(vertex.z() - 1.0), 0.0005, 1e-9);
  expect_sound(hull, 1e-6);
  ASSERT_EQ(made.remarks.size(), 1u);
  EXPECT_EQ(made.remarks[0].message, "it is flat: contact takes it to be 1 mm thick");
}

TEST(ConvexHull, RefusesALineAPointAndNothing) {
  const auto message = [](MeshPart part) {
    const auto hulls = convex_hulls(mesh_of({box_part({1, 1, 1}), std::move(part)}));
    return hulls ? std::string() : hulls.errors().front().message;
  };
  EXPECT_EQ(message(part_of({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}, 1)),
            "object 1 is a line and can't be touched");
  EXPECT_EQ(message(part_of({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}, 1)),
            "object 1 is a single point and can't be touched");
  EXPECT_EQ(message(part_of({{1, 2, 3}}, {}, 1)), "object 1 has no triangles");
  EXPECT_EQ(message(part_of({{0, 0, 0}, {1, 0, 0}, {std::nan(""), 1, 0}}, {{0, 1, 2}}, 1)),
            "object 1 has a vertex that is not finite");
}

TEST(ConvexHull, StandsThinPlatesAndCrookedCones) {
  // shapes for which Qhull failed in practice: plates 2000 times as wide as thick, needles, many points on one circle
  std::vector<MeshPart> hard{box_part({2, 1, 0.001}), box_part({0.001, 0.001, 3}, {100, -50, 20})};
  std::vector<Vector3d> cone{{0.3, 0.1, 2.0}};
  Triangles sides;
  for (std::uint32_t i = 0; i < 90; ++i) {
    cone.push_back({0.01 * std::cos(i * M_PI / 45), 0.01 * std::sin(i * M_PI / 45), 0.0});
    sides.push_back({0, 1 + i, 1 + (i + 1) % 90});
  }
  hard.push_back(part_of(cone, sides));
  for (const MeshPart& part : hard) {
    const MeshData mesh = mesh_of({part});
    const ConvexHull hull = hulls_of(mesh).hulls[0];
    SCOPED_TRACE(hull.vertices.size());
    expect_sound(hull, 1e-6 * (mesh.upper - mesh.lower).norm() + 5e-7 * mesh.upper.norm());
    for (const auto& face : hull.faces)
      for (const Eigen::Vector3f& vertex : part.vertices) EXPECT_LE(above(hull, face, vertex.cast<double>()), 2e-4);
  }
}

}  // namespace
}  // namespace rehearse
