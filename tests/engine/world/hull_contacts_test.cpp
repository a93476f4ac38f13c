// Contacts of hulls, compared with a brute-force computation.

#include "world/hull_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../meshes.h"
#include "mesh/convex_hull.h"

namespace rehearse {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Polytope polytope_of(const MeshPart& part) {
  auto hulls = convex_hulls(mesh_of({part}));
  EXPECT_TRUE(hulls.ok());
  return Polytope(hulls->hulls.at(0));
}

/// Numbers between -1 and 1, the same on every machine.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double next() { return engine_() / 2147483648.0 - 1.0; }
  Vector3d point() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }
  Isometry3d pose(double reach) {
    Isometry3d pose = Isometry3d::Identity();
    pose.translation() = reach * point();
    const double w = next();
    const Vector3d axis = point();
    pose.linear() = Eigen::Quaterniond(w, axis.x(), axis.y(), axis.z()).normalized().toRotationMatrix();
    return pose;
  }

 private:
  std::mt19937 engine_;
};

/// The hull of random points in a box around the origin.
Polytope stone(Numbers& numbers, int count, const Vector3d& size) {
  std::vector<Vector3d> points;
  Triangles triangles;
  for (int i = 0; i < count; ++i) points.push_back(numbers.point().cwiseProduct(0.5 * size));
  for (std::uint32_t i = 0; i + 2 < points.size(); ++i) triangles.push_back({i, i + 1, i + 2});
  return polytope_of(part_of(points, triangles));
}

/// A prism about z with this number of corners.
Polytope prism(int corners, double radius, double half_length) {
  std::vector<Vector3d> points;
  for (int i = 0; i < corners; ++i)
    for (const double z : {-half_length, half_length})
      points.push_back({radius * std::cos(2 * M_PI * i / corners), radius * std::sin(2 * M_PI * i / corners), z});
  Triangles triangles;
  for (std::uint32_t i = 0; i + 2 < points.size(); ++i) triangles.push_back({i, i + 1, i + 2});
  return polytope_of(part_of(points, triangles));
}

double least(const std::vector<Vector3d>& points, const Vector3d& direction) {
  double value = points[0].dot(direction);
  for (const Vector3d& point : points) value = std::min(value, point.dot(direction));
  return value;
}

/// The overlap along the direction in which it is least: all normals of faces and all cross products of edges are
/// tried. Negative if they don't overlap.
double overlap(const Polytope& a, const PlacedPolytope& b) {
  std::vector<Vector3d> directions;
  for (const Plane& plane : a.planes()) directions.push_back(plane.normal);
  for (const Plane& plane : b.planes) directions.push_back(plane.normal);
  for (const PolytopeEdge& ea : a.edges()) {
    for (const PolytopeEdge& eb : b.shape.edges()) {
      const Vector3d direction =
          (a.vertices()[ea.to] - a.vertices()[ea.from]).cross(b.vertices[eb.to] - b.vertices[eb.from]);
      if (direction.norm() > 1e-9) directions.push_back(direction.normalized());
    }
  }
  double smallest = 1e30;
  for (const Vector3d& direction : directions)
    for (const Vector3d& d : {direction, Vector3d(-direction)})
      smallest = std::min(smallest, -least(a.vertices(), -d) - least(b.vertices, d));
  return smallest;
}

double depth_of(const std::vector<TouchPoint>& touches) {
  double depth = -1.0;
  for (const TouchPoint& touch : touches) depth = std::max(depth, touch.depth);
  return depth;
}

TEST(HullContacts, HaveTheDepthOfTheLeastOverlap) {
  Numbers numbers(1);
  int touching = 0, apart = 0;
  for (int i = 0; i < 1500; ++i) {
    const Polytope a = stone(numbers, 6 + i % 20, {1.0, 0.8, 0.6});
    const Polytope b = i % 3 == 0 ? Polytope(Box{{0.7, 0.5, 0.3}}) : stone(numbers, 5 + i % 13, {0.5, 0.6, 0.9});
    const PlacedPolytope placed(b, numbers.pose(0.7));
    const double expected = overlap(a, placed);
    const std::vector<TouchPoint> touches = touch_hull(a, placed);
    if (expected <= 0.0) {
      ++apart;
      EXPECT_TRUE(touches.empty()) << "pair " << i << ", gap " << -expected << ", depth " << depth_of(touches);
      continue;
    }
    ++touching;
    ASSERT_FALSE(touches.empty()) << "pair " << i << ", overlap " << expected;
    EXPECT_LE(touches.size(), max_touches);
    // a face is taken where another one, and then an edge, is better by less than a twentieth
    EXPECT_GE(depth_of(touches), expected - 1e-9) << "pair " << i;
    EXPECT_LE(depth_of(touches), expected / (0.95 * 0.95) + 2.2e-6) << "pair " << i;
    for (const TouchPoint& touch : touches) {
      EXPECT_NEAR(touch.normal.norm(), 1.0, 1e-9);
      // half way between both surfaces: not farther outside of either than they overlap
      for (const Plane& plane : a.planes()) EXPECT_LE(plane.distance(touch.position), expected) << "pair " << i;
      for (const Plane& plane : placed.planes) EXPECT_LE(plane.distance(touch.position), expected) << "pair " << i;
    }
  }
  EXPECT_GT(touching, 300);
  EXPECT_GT(apart, 300);
}

TEST(HullContacts, NormalsPointOutOfTheFirstHull) {
  Numbers numbers(2);
  for (int i = 0; i < 300; ++i) {
    const Polytope a = stone(numbers, 12, {1, 1, 1}), b = stone(numbers, 12, {1, 1, 1});
    const Isometry3d pose = numbers.pose(0.6);
    const auto touches = touch_hull(a, PlacedPolytope(b, pose));
    if (touches.empty()) continue;
    // moved along it by the depth, the other one is free
    Isometry3d away = pose;
    away.translation() += 1.001 * (depth_of(touches) + 1e-6) * touches[0].normal;
    EXPECT_LE(overlap(a, PlacedPolytope(b, away)), 1e-9);
  }
}

TEST(HullContacts, OfCylindersAreThoseOfAFinePrism) {
  Numbers numbers(3);
  const double radius = 0.3, half_length = 0.4;
  const Polytope fine = prism(60, radius, half_length);
  int touching = 0;
  for (int i = 0; i < 600; ++i) {
    const Polytope a = i % 4 == 0 ? Polytope(Box{{0.7, 0.5, 0.3}}) : stone(numbers, 6 + i % 20, {1.0, 0.8, 0.6});
    const Isometry3d pose = numbers.pose(0.8);
    const double depth = depth_of(touch_cylinder(a, {pose.translation(), pose.linear(), radius, half_length}));
    const double reference = overlap(a, PlacedPolytope(fine, pose));
    const double finer = radius * (1.0 - std::cos(M_PI / 60)) + 2e-6;  // how far the cylinder sticks out of the prism
    if (reference < 0.0) {
      EXPECT_LE(depth, finer) << "pair " << i;
    } else {
      ++touching;
      EXPECT_GE(depth, 0.95 * reference - 2e-6) << "pair " << i;
      EXPECT_LE(depth, reference / 0.95 + finer) << "pair " << i;
    }
  }
  EXPECT_GT(touching, 150);
}

/// The distance of a segment from a hull by sampling; only for positive distances.
double distance(const Polytope& hull, const Vector3d& from, const Vector3d& to) {
  double nearest = 1e30;
  const PlacedPolytope at(hull, Isometry3d::Identity());
  for (int k = 0; k <= 400; ++k) {
    // alternating projections: onto the half spaces, with Dykstra's corrections
    const Vector3d start = from + k / 400.0 * (to - from);
    Vector3d x = start;
    std::vector<Vector3d> corrections(hull.planes().size(), Vector3d::Zero());
    for (int round = 0; round < 300; ++round) {
      const Vector3d before = x;
      for (std::size_t f = 0; f < hull.planes().size(); ++f) {
        const Vector3d y = x + corrections[f];
        x = y - std::max(0.0, hull.planes()[f].distance(y)) * hull.planes()[f].normal;
        corrections[f] = y - x;
      }
      if ((x - before).norm() < 1e-9) break;
    }
    nearest = std::min(nearest, (x - start).norm());
  }
  return nearest;
}

TEST(HullContacts, OfSpheresAndCapsulesHaveTheDepthOfTheirMiddlesDistance) {
  Numbers numbers(4);
  int touching = 0;
  for (int i = 0; i < 400; ++i) {
    const Polytope a = stone(numbers, 6 + i % 10, {1.0, 0.8, 0.6});
    const Isometry3d pose = numbers.pose(0.9);
    const double radius = 0.15, half_length = i % 2 == 0 ? 0.0 : 0.3;
    const Vector3d reach = half_length * pose.linear().col(2);
    const double gap = distance(a, pose.translation() - reach, pose.translation() + reach);
    if (gap < 1e-6) continue;  // the middle is inside
    const auto touches = half_length == 0.0
                             ? touch_sphere(a, pose.translation(), radius)
                             : touch_capsule(a, {pose.translation(), pose.linear(), radius, half_length});
    if (gap > radius) {
      EXPECT_TRUE(touches.empty()) << "pair " << i << ", gap " << gap - radius << ", depth " << depth_of(touches);
    } else {
      ++touching;
      EXPECT_NEAR(depth_of(touches), radius - gap, 2e-3 * radius) << "pair " << i;
    }
  }
  EXPECT_GT(touching, 20);
}

TEST(HullContacts, OfFacesHaveTheirCorners) {
  const Polytope cube(Box{{1, 1, 1}});
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(0.25, 0.25, 0.999);
  auto touches = touch_hull(cube, PlacedPolytope(cube, pose));
  ASSERT_EQ(touches.size(), 4u);
  std::vector<std::pair<double, double>> places;
  for (const TouchPoint& touch : touches) {
    EXPECT_NEAR(touch.depth, 0.001, 1e-12);
    EXPECT_NEAR(touch.position.z(), 0.4995, 1e-12);
    EXPECT_EQ(touch.normal, Vector3d(0, 0, 1));
    places.emplace_back(touch.position.x(), touch.position.y());
  }
  std::ranges::sort(places);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(places[static_cast<std::size_t>(i)].first, i < 2 ? -0.25 : 0.5, 1e-12);
    EXPECT_NEAR(places[static_cast<std::size_t>(i)].second, i % 2 == 0 ? -0.25 : 0.5, 1e-12);
  }
}

TEST(HullContacts, OfManyCornersAreEightAllAround) {
  const Polytope plate = prism(40, 1.0, 0.1);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation().z() = 0.199;
  const auto touches = touch_hull(plate, PlacedPolytope(plate, pose));
  ASSERT_EQ(touches.size(), max_touches);
  std::vector<double> angles;
  for (const TouchPoint& touch : touches) angles.push_back(std::atan2(touch.position.y(), touch.position.x()));
  std::ranges::sort(angles);
  for (std::size_t i = 1; i < angles.size(); ++i) EXPECT_LT(angles[i] - angles[i - 1], 1.2);
}

TEST(HullContacts, OfACrossingOfEdgesIsOnePoint) {
  // two wedges, the edge of one along y and of the other along x
  const std::vector<Vector3d> corners{{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}, {0, -1, 1}, {0, 1, 1}};
  const Polytope wedge = polytope_of(part_of(corners, {{0, 1, 2}, {3, 4, 5}}));
  Isometry3d turned = Isometry3d::Identity();
  turned.linear() << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  turned.translation().z() = 1.99;
  const auto touches = touch_hull(wedge, PlacedPolytope(wedge, turned));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_NEAR(touches[0].depth, 0.01, 1e-6);
  EXPECT_LT((touches[0].position - Vector3d(0, 0, 0.995)).norm(), 1e-6);
  EXPECT_LT((touches[0].normal - Vector3d::UnitZ()).norm(), 1e-6);
}

}  // namespace
}  // namespace rehearse
