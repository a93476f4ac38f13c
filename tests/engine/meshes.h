// Meshes and hulls made by code, for tests.
#pragma once

#include <rehearse/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace rehearse {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

inline MeshPart part_of(const std::vector<Eigen::Vector3d>& vertices, Triangles triangles, int object = 0) {
  MeshPart part;
  part.object = object;
  for (const Eigen::Vector3d& vertex : vertices) part.vertices.push_back(vertex.cast<float>());
  part.triangles = std::move(triangles);
  return part;
}

inline MeshData mesh_of(std::vector<MeshPart> parts) {
  MeshData mesh;
  mesh.file = "thing.stl";
  mesh.lower.setConstant(1e30);
  mesh.upper.setConstant(-1e30);
  for (const MeshPart& part : parts) {
    for (const Eigen::Vector3f& vertex : part.vertices) {
      mesh.lower = mesh.lower.cwiseMin(vertex.cast<double>());
      mesh.upper = mesh.upper.cwiseMax(vertex.cast<double>());
    }
  }
  mesh.parts = std::move(parts);
  return mesh;
}

/// A box about `center` [m]: 8 vertices, 12 triangles.
inline MeshPart box_part(const Eigen::Vector3d& size, const Eigen::Vector3d& center = Eigen::Vector3d::Zero(),
                         int object = 0) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i)
    vertices.push_back(center +
                       size.cwiseProduct(Eigen::Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5)));
  return part_of(vertices,
                 {{0, 2, 1},
                  {1, 2, 3},
                  {4, 5, 6},
                  {5, 7, 6},
                  {0, 1, 4},
                  {1, 5, 4},
                  {2, 6, 3},
                  {3, 6, 7},
                  {0, 4, 2},
                  {2, 4, 6},
                  {1, 3, 5},
                  {3, 7, 5}},
                 object);
}

/// A globe with this number of meridians and parallels [m].
inline MeshPart globe_part(double radius, int meridians, int parallels,
                           const Eigen::Vector3d& center = Eigen::Vector3d::Zero()) {
  std::vector<Eigen::Vector3d> vertices;
  Triangles triangles;
  for (int i = 0; i <= parallels; ++i) {
    for (int j = 0; j < meridians; ++j) {
      const double polar = M_PI * i / parallels, around = 2.0 * M_PI * j / meridians;
      vertices.push_back(center + radius * Eigen::Vector3d(std::sin(polar) * std::cos(around),
                                                           std::sin(polar) * std::sin(around), std::cos(polar)));
      if (i == parallels) continue;
      const auto at = [&](int row, int column) {
        return static_cast<std::uint32_t>(row * meridians + column % meridians);
      };
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return part_of(vertices, std::move(triangles));
}

}  // namespace rehearse
