// Bodies of meshes made by code, for tests of the world.
#pragma once

#include "../meshes.h"
#include "mesh/convex_hull.h"
#include "robots.h"

namespace rehearse {

inline Mesh mesh_shape(MeshData mesh) {
  auto hulls = convex_hulls(mesh);
  EXPECT_TRUE(hulls.ok());
  return {std::make_shared<const MeshData>(std::move(mesh)),
          std::make_shared<const std::vector<ConvexHull>>(std::move(hulls->hulls))};
}

inline Mesh box_mesh(const Eigen::Vector3d& size) { return mesh_shape(mesh_of({box_part(size)})); }

/// A body with the inertia of `like`, whatever its shape.
inline WorldBody body_with(const std::string& name, const Geometry& geometry, const Geometry& like, double mass,
                           const Eigen::Vector3d& position) {
  Model model = single_shape_model(name, like, mass, {});
  model.links[0].collisions[0].geometry = geometry;
  return body_of(std::make_shared<const Model>(std::move(model)), position);
}

inline WorldBody fixed(WorldBody body) {
  body.fixed = true;
  return body;
}

struct Thing {
  const char* what;
  Geometry geometry;
  Geometry like;  // determines the inertia
  double height;  // of its centre on the ground [m]
};

/// A thing of each kind of shape, standing upright.
inline std::vector<Thing> things() {
  const Box box{{0.2, 0.2, 0.2}};
  return {{"box", box, box, 0.1},
          {"hull", box_mesh(box.size), box, 0.1},
          {"sphere", Sphere{0.1}, Sphere{0.1}, 0.1},
          {"capsule", Capsule{0.1, 0.3}, Capsule{0.1, 0.3}, 0.25},
          {"cylinder", Cylinder{0.1, 0.3}, Cylinder{0.1, 0.3}, 0.15}};
}

/// The ground's height at x, y, as a mesh of square cells over 4 m by 4 m, each of two triangles.
template <class Height>
MeshData ground_mesh(int cells, Height height) {
  std::vector<Eigen::Vector3d> vertices;
  Triangles triangles;
  const auto at = [cells](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const double x = 4.0 * i / cells - 2.0, y = 4.0 * j / cells - 2.0;
      vertices.push_back({x, y, height(x, y)});
      if (i == cells || j == cells) continue;
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh_of({part_of(vertices, std::move(triangles))});
}

/// A fixed body whose contacts use its triangles.
inline WorldBody trimesh_body(const std::string& name, MeshData mesh,
                              const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  const Mesh shape{std::make_shared<const MeshData>(std::move(mesh)), nullptr};
  return fixed(body_with(name, shape, Box{{1, 1, 1}}, 0.0, position));
}

}  // namespace rehearse
