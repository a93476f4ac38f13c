// Meshes made by code, for the renderer's tests.
#pragma once

#include <rehearse/model.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace rehearse {

inline Mesh mesh_of(std::vector<MeshPart> parts) {
  auto data = std::make_shared<MeshData>();
  Eigen::AlignedBox3d box;
  for (const MeshPart& part : parts)
    for (const Eigen::Vector3f& vertex : part.vertices) box.extend(vertex.cast<double>());
  data->parts = std::move(parts);
  if (!box.isEmpty()) {
    data->lower = box.min();
    data->upper = box.max();
  }
  return {data, nullptr};
}

/// A rectangle about z, facing +z, whose texture coordinates run from (0, 0) at its lower left to `repeats` each way.
inline MeshPart quad(double width, double height, float repeats = 1.0f) {
  MeshPart part;
  const auto x = static_cast<float>(0.5 * width), y = static_cast<float>(0.5 * height);
  part.vertices = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  part.normals.assign(4, Eigen::Vector3f::UnitZ());
  part.texture_coordinates = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
  part.triangles = {{0, 1, 2}, {0, 2, 3}};
  return part;
}

/// The same triangles seen from the other side.
inline MeshPart wound_backwards(MeshPart part) {
  for (auto& triangle : part.triangles) std::swap(triangle[1], triangle[2]);
  return part;
}

inline MeshPart with_normals_turned(MeshPart part) {
  for (Eigen::Vector3f& normal : part.normals) normal = -normal;
  return part;
}

inline MeshPart moved(MeshPart part, const Eigen::Vector3f& by) {
  for (Eigen::Vector3f& vertex : part.vertices) vertex += by;
  return part;
}

/// A box; each face has separate vertices and normals.
inline MeshPart cuboid(const Eigen::Vector3d& size) {
  MeshPart part;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      const auto first = static_cast<std::uint32_t>(part.vertices.size());
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const auto& [along_u, along_v] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        Eigen::Vector3d corner;
        corner[axis] = side * size[axis];
        corner[u] = (side > 0 ? along_u : -along_u) * size[u];
        corner[v] = along_v * size[v];
        part.vertices.push_back(corner.cast<float>());
        part.normals.push_back((2.0 * side * Eigen::Vector3d::Unit(axis)).cast<float>());
      }
      part.triangles.push_back({first, first + 1, first + 2});
      part.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return part;
}

/// A sphere of rings from the upper pole to the lower, each of twice as many segments. Its vertices are on the sphere.
inline MeshPart ball(double radius, std::uint32_t rings) {
  MeshPart part;
  const std::uint32_t segments = 2 * rings;
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (std::uint32_t i = 0; i <= segments; ++i) {
      // the first and the last vertex have the same bits
      const double around = 2.0 * std::numbers::pi * (i % segments) / segments;
      const double r = ring % rings == 0 ? 0.0 : std::sin(polar);
      const Eigen::Vector3d normal(r * std::cos(around), r * std::sin(around), std::cos(polar));
      part.normals.push_back(normal.cast<float>());
      part.vertices.push_back((radius * normal).cast<float>());
      part.texture_coordinates.emplace_back(static_cast<float>(i) / static_cast<float>(segments),
                                            1.0f - static_cast<float>(ring) / static_cast<float>(rings));
    }
  }
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t upper = ring * (segments + 1) + i, lower = upper + segments + 1;
      part.triangles.push_back({lower, lower + 1, upper + 1});
      part.triangles.push_back({lower, upper + 1, upper});
    }
  }
  return part;
}

/// Pixels row by row from the top left: red, green, blue, opacity.
inline std::shared_ptr<const Texture> texture_of(int width, int height,
                                                 const std::vector<std::array<std::uint8_t, 4>>& pixels) {
  auto texture = std::make_shared<Texture>();
  texture->width = width;
  texture->height = height;
  for (const auto& pixel : pixels) texture->rgba.insert(texture->rgba.end(), pixel.begin(), pixel.end());
  return texture;
}

inline MeshPart with_texture(MeshPart part, std::shared_ptr<const Texture> texture) {
  part.texture = std::move(texture);
  return part;
}

inline MeshPart with_color(MeshPart part, const Color& color) {
  part.color = color;
  return part;
}

}  // namespace rehearse
