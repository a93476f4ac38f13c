#include "renderer/renderer_meshes.h"
#include "support/printed_by_name.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <map>
#include <ostream>
#include <string>
#include <tuple>

namespace rehearse {
namespace {

/// The place of a vertex when the halves of a capsule are shifted by 1 each way.
Eigen::Vector3d place(const Vertex& v) {
  return Eigen::Vector3d(v.position[0], v.position[1], v.position[2] + v.shift);
}

struct NamedMesh {
  std::string name;
  UnitMesh mesh;
};

class RendererMeshes : public testing::TestWithParam<NamedMesh> {
 protected:
  template <class Visit>
  void for_each_triangle(const UnitMesh& mesh, Visit visit) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      visit(mesh.vertices[mesh.indices[i]], mesh.vertices[mesh.indices[i + 1]], mesh.vertices[mesh.indices[i + 2]]);
    }
  }
};

TEST_P(RendererMeshes, AreClosed) {
  using Place = std::tuple<double, double, double>;
  const auto key = [](const Vertex& v) { return Place(place(v).x(), place(v).y(), place(v).z()); };
  std::map<std::pair<Place, Place>, int> edges;
  for_each_triangle(GetParam().mesh, [&](const Vertex& a, const Vertex& b, const Vertex& c) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      ++edges[{key(from), key(to)}];
      --edges[{key(to), key(from)}];
    }
  });
  for (const auto& [edge, open] : edges) EXPECT_EQ(open, 0);
}

TEST_P(RendererMeshes, FaceOutwardsAsTheirNormalsSay) {
  for_each_triangle(GetParam().mesh, [&](const Vertex& a, const Vertex& b, const Vertex& c) {
    const Eigen::Vector3d face = (place(b) - place(a)).cross(place(c) - place(a));
    EXPECT_GT(face.norm(), 0.0) << "a triangle without area";
    EXPECT_GT(face.dot(place(a) + place(b) + place(c)), 0.0);
    for (const Vertex& v : {a, b, c}) {
      const Eigen::Vector3d normal(v.normal[0], v.normal[1], v.normal[2]);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
      EXPECT_GT(normal.dot(face.normalized()), 0.99);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(All, RendererMeshes,
                         testing::Values(NamedMesh{"Box", box_mesh()}, NamedMesh{"Sphere", sphere_mesh()},
                                         NamedMesh{"Cylinder", cylinder_mesh()}, NamedMesh{"Capsule", capsule_mesh()}),
                         test::by_name);

TEST(RendererMeshesOfRoundShapes, StayWithinTheStatedErrorOfTheirRadius) {
  constexpr double stated = 0.0008;
  const UnitMesh sphere = sphere_mesh();
  for (std::size_t i = 0; i < sphere.indices.size(); i += 3) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(place(sphere.vertices[sphere.indices[i + k]]).norm(), 1.0, stated);
      centre += place(sphere.vertices[sphere.indices[i + k]]) / 3.0;
    }
    EXPECT_NEAR(centre.norm(), 1.0, stated);
  }
  const UnitMesh cylinder = cylinder_mesh();
  for (const Vertex& v : cylinder.vertices) EXPECT_NEAR(place(v).head<2>().norm(), 1.0, stated);
}

}  // namespace
}  // namespace rehearse
