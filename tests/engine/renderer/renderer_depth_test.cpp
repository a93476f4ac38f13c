// Depth against ray casting: each pixel's ray is followed through the shape's distance function, in double.
#include "scene.h"

#include <limits>

namespace rehearse {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Signed distance from a point in the shape's frame to its surface [m].
double distance_to(const Geometry& geometry, const Eigen::Vector3d& p) {
  struct Distance {
    Eigen::Vector3d p;
    static double outside_and_in(const Eigen::VectorXd& excess) {
      return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
    }
    double operator()(const Box& box) const { return outside_and_in(p.cwiseAbs() - 0.5 * box.size); }
    double operator()(const Sphere& sphere) const { return p.norm() - sphere.radius; }
    double operator()(const Cylinder& c) const {
      return outside_and_in(Eigen::Vector2d(std::hypot(p.x(), p.y()) - c.radius, std::abs(p.z()) - 0.5 * c.length));
    }
    double operator()(const Capsule& c) const {
      return Eigen::Vector3d(p.x(), p.y(), std::max(std::abs(p.z()) - 0.5 * c.length, 0.0)).norm() - c.radius;
    }
    double operator()(const Mesh&) const {
      ADD_FAILURE() << "no analytic distance to a mesh";
      return 0.0;
    }
  };
  return std::visit(Distance{p}, geometry);
}

Eigen::Vector3d normal_of(const Geometry& geometry, const Eigen::Vector3d& p) {
  constexpr double step = 1e-6;
  Eigen::Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(i);
    gradient[i] = distance_to(geometry, p + offset) - distance_to(geometry, p - offset);
  }
  return gradient.normalized();
}

/// Through the centre of a pixel, in the camera's frame, of length 1 along the optical axis.
Eigen::Vector3d ray_through(const Camera& camera, int x, int y) {
  const double shorter_side = camera.width >= camera.height ? camera.height : camera.width;
  const double per_pixel = 2.0 * std::tan(0.5 * camera.field_of_view) / shorter_side;
  return {per_pixel * (x + 0.5 - 0.5 * camera.width), per_pixel * (0.5 * camera.height - y - 0.5), -1.0};
}

struct Hit {
  double depth = infinite;      // [m]
  double facing = 0.0;          // cosine between the ray and the surface's normal
  double clearance = infinite;  // how near the ray comes to a shape that it misses [m]
};

Hit cast(const Shape& shape, const Camera& camera, const Eigen::Isometry3d& pose, int x, int y) {
  const Eigen::Isometry3d shape_from_camera = shape.pose.inverse() * pose;
  const Eigen::Vector3d ray = shape_from_camera.linear() * ray_through(camera, x, y);
  Hit hit;
  double depth = 0.0;
  for (int i = 0; i < 100000 && depth < camera.far_clip; ++i) {
    const Eigen::Vector3d p = shape_from_camera.translation() + depth * ray;
    const double distance = distance_to(shape.geometry, p);
    if (distance < 1e-9 * (1.0 + depth)) return {depth, -ray.normalized().dot(normal_of(shape.geometry, p)), 0.0};
    hit.clearance = std::min(hit.clearance, distance);
    depth += distance / ray.norm();
  }
  return hit;
}

/// Compares every `stride`th pixel each way, except for grazing rays, where a small error of the surface is a large one
/// in depth. Returns the number of pixels with a hit.
int expect_depth(const Shape& shape, const Camera& camera, const Eigen::Isometry3d& pose, int stride = 5,
                 double least_facing = 0.25) {
  const auto renderer = make_renderer();
  renderer->add(shape, grey);
  const DepthImage depth = renderer->draw(camera, pose).depth;
  int hits = 0;
  for (int y = 0; y < camera.height; y += stride) {
    for (int x = 0; x < camera.width; x += stride) {
      const Hit expected = cast(shape, camera, pose, x, y);
      const float seen = meters(depth, x, y);
      if (expected.depth == infinite) {
        if (expected.clearance > 0.01) {
          EXPECT_EQ(seen, infinite) << x << ", " << y;
        }
      } else if (expected.facing > least_facing && expected.depth < 0.999 * camera.far_clip) {
        EXPECT_NEAR(seen, expected.depth, 0.001 + 0.001 * expected.depth) << x << ", " << y;
        ++hits;
      }
    }
  }
  return hits;
}

TEST(RendererDepth, OfABoxIsThatOfItsRays) {
  Shape box = shape_at(Box{{0.6, 0.4, 0.8}}, {0.2, -0.1, 0.3});
  box.pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_GT(expect_depth(box, camera_of(320, 240), look_at({2.0, -1.0, 1.5}, {0.1, 0.0, 0.3})), 100);
}

TEST(RendererDepth, OfASphereIsThatOfItsRays) {
  const Shape sphere = shape_at(Sphere{0.5}, {0.0, 0.1, 0.2});
  EXPECT_GT(expect_depth(sphere, camera_of(320, 240), look_at({1.5, -0.5, 0.9}, {0.1, 0.0, 0.2})), 100);
}

TEST(RendererDepth, OfACylinderIsThatOfItsRays) {
  Shape cylinder = shape_at(Cylinder{0.3, 0.9}, {0.1, 0.0, 0.2});
  cylinder.pose.rotate(Eigen::AngleAxisd(-0.5, Eigen::Vector3d(3, 1, 0).normalized()));
  EXPECT_GT(expect_depth(cylinder, camera_of(320, 240), look_at({1.2, 1.0, 1.3}, {0.1, 0.0, 0.2})), 100);
}

TEST(RendererDepth, OfACapsuleIsThatOfItsRays) {
  Shape capsule = shape_at(Capsule{0.25, 0.7}, {0.1, 0.0, 0.2});
  capsule.pose.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0, 1, 1).normalized()));
  EXPECT_GT(expect_depth(capsule, camera_of(320, 240), look_at({1.2, 1.0, 1.3}, {0.1, 0.0, 0.2})), 100);
}

TEST(RendererDepth, OfAPortraitPictureIsThatOfItsRays) {
  const Shape sphere = shape_at(Sphere{0.5}, {0.0, 0.1, 0.2});
  EXPECT_GT(expect_depth(sphere, camera_of(120, 320), look_at({1.5, -0.5, 0.9}, {0.1, 0.0, 0.2})), 50);
}

TEST(RendererDepth, IsRightFromTheNearClipToTheFarClip) {
  for (const double distance : {0.0405, 0.05, 0.1, 0.5, 2.0, 10.0, 50.0, 150.0, 199.5}) {
    const Shape wall = shape_at(Box{{1.0, 500.0, 500.0}}, {distance + 0.5, 0.0, 0.0});
    EXPECT_GT(expect_depth(wall, camera_of(64, 48), look_at({0, 0, 0}, {1, 0, 0})), 50) << distance;
  }
}

// The floor runs from under the camera to the far clip: its triangles are much larger than the picture, which is where
// interpolation in single precision is at its worst.
TEST(RendererDepth, OfAnEndlessFloorIsRightUpToTheHorizon) {
  const Shape floor = shape_at(Box{{1000.0, 1000.0, 1.0}}, {0.0, 0.0, -0.5});
  for (const double height : {0.05, 0.3, 1.5, 20.0}) {
    const Eigen::Isometry3d pose = look_at({0, 0, height}, {1.0, 0.3, height - 0.2});
    EXPECT_GT(expect_depth(floor, camera_of(320, 240), pose, 5, 0.0), 500) << height;
  }
}

TEST(RendererDepth, IsInfiniteWhereNothingIs) {
  const auto renderer = make_renderer();
  for (const float depth : renderer->draw(camera_of(4, 3), Eigen::Isometry3d::Identity()).depth.meters) {
    EXPECT_EQ(depth, infinite);
  }
}

TEST(RendererDepth, OfSomethingBeyondTheFarClipIsInfinite) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, -5.5}), red);
  Camera camera = camera_of(1, 1, 0.1);
  camera.far_clip = 5.01;
  EXPECT_NEAR(renderer->draw(camera, Eigen::Isometry3d::Identity()).depth.meters[0], 5.0, 0.005);
  camera.far_clip = 4.99;
  EXPECT_EQ(renderer->draw(camera, Eigen::Isometry3d::Identity()).depth.meters[0], infinite);
}

TEST(RendererDepth, SeesThroughWhatIsBeforeTheNearClip) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, -1.5}), red);   // from 1 m
  renderer->add(shape_at(Box{{4, 4, 1}}, {0, 0, -3.5}), blue);  // from 3 m
  Camera camera = camera_of(1, 1, 0.1);
  camera.near_clip = 0.99;
  EXPECT_NEAR(renderer->draw(camera, Eigen::Isometry3d::Identity()).depth.meters[0], 1.0, 0.002);
  camera.near_clip = 1.01;
  EXPECT_NEAR(renderer->draw(camera, Eigen::Isometry3d::Identity()).depth.meters[0], 3.0, 0.004);
}

TEST(RendererDepth, IsOnlyThereWhenAskedFor) {
  const auto renderer = make_renderer();
  Camera camera = camera_of(8, 6);
  EXPECT_EQ(renderer->draw(camera, Eigen::Isometry3d::Identity()).depth.meters.size(), 48u);
  camera.depth = false;
  const DepthImage none = renderer->draw(camera, Eigen::Isometry3d::Identity()).depth;
  EXPECT_TRUE(none.meters.empty());
  EXPECT_EQ(none.width, 0);
  EXPECT_EQ(none.height, 0);
}

TEST(RendererDepth, TellsSurfacesApartThatAreACentimetreApartAtTenMetres) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{4, 4, 1}}, {0, 0, -10.50}), blue);
  renderer->add(shape_at(Box{{4, 4, 1}}, {0, 0, -10.49}), red);
  const Frame frame = renderer->draw(camera_of(32, 24, 0.3), Eigen::Isometry3d::Identity());
  for (int x = 0; x < 32; ++x) EXPECT_EQ(hue(pixel(frame.color, x, 12)), Hue::reddish) << x;
}

}  // namespace
}  // namespace rehearse
