// Invisible shapes aren't drawn. The test draws the scene with a wider field of view, too: the middle of that picture
// must equal the narrow picture.
#include "mesh_shapes.h"
#include "scene.h"
#include "support/printed_by_name.h"

#include <cstdlib>
#include <ostream>
#include <string>

namespace rehearse {
namespace {

constexpr int width = 96, height = 64;  // of the narrow picture; the wide one has three times as many each way

Camera narrow_camera() {
  Camera camera = camera_of(width, height, 1.2);
  camera.far_clip = 5.0;
  return camera;
}

Camera wide_camera() {
  Camera camera = narrow_camera();
  camera.width *= 3;
  camera.height *= 3;
  camera.field_of_view = 2.0 * std::atan(3.0 * std::tan(0.5 * camera.field_of_view));
  return camera;
}

/// The number of pixels of the narrow picture, or of those in the middle of the wide one, that show a shape.
int hits(Renderer& renderer, const Camera& camera) {
  const DepthImage depth = renderer.draw(camera, Eigen::Isometry3d::Identity()).depth;
  int count = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      count += std::isfinite(meters(depth, x + (camera.width - width) / 2, y + (camera.height - height) / 2));
    }
  }
  return count;
}

struct NamedGeometry {
  std::string name;
  Geometry geometry;
};

class RendererCulling : public testing::TestWithParam<NamedGeometry> {};

TEST_P(RendererCulling, LeavesOutOnlyWhatIsOutside) {
  const auto renderer = make_renderer();
  const int number = renderer->add(shape_at(GetParam().geometry, {0, 0, 0}), grey);
  int partly = 0;
  for (double x = -2.9; x <= 2.9; x += 0.29) {
    for (double y = -2.1; y <= 2.1; y += 0.31) {
      for (const double z : {-2.0, -0.6, 0.3, -5.2}) {
        renderer->set_link_pose(number, Eigen::Translation3d(x, y, z) *
                                            Eigen::AngleAxisd(x + 2.0 * y, Eigen::Vector3d(1, y, 1).normalized()));
        const int expected = hits(*renderer, wide_camera());
        const int seen = hits(*renderer, narrow_camera());
        EXPECT_LE(std::abs(seen - expected), 2) << x << " " << y << " " << z;  // edges may round to either side
        partly += expected > 1 && expected < width * height / 20;
      }
    }
  }
  EXPECT_GT(partly, 30) << "hardly a shape reached into the picture";
}

INSTANTIATE_TEST_SUITE_P(Of, RendererCulling,
                         testing::Values(NamedGeometry{"Box", Box{{0.9, 0.1, 0.2}}},
                                         NamedGeometry{"Sphere", Sphere{0.4}},
                                         NamedGeometry{"Cylinder", Cylinder{0.05, 1.0}},
                                         NamedGeometry{"Capsule", Capsule{0.1, 0.8}},
                                         NamedGeometry{"MeshBesideItsOrigin",
                                                       mesh_of({moved(cuboid({0.6, 0.1, 0.2}), {0.5f, 0.3f, -0.4f})})}),
                         test::by_name);

}  // namespace
}  // namespace rehearse
