// Meshes: the triangles of a model's shapes, as they were read from files. Immutable, and shared by all shapes, models
// and worlds that use the same file at the same scale.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// A picture that is laid on a mesh. Pixels are red, green, blue, opacity, row by row, the top row first.
struct Texture {
  int width = 0;   // [pixels]
  int height = 0;  // [pixels]
  std::vector<std::uint8_t> rgba;
  std::string file;  // where it comes from, for messages
};

/// Triangles of one material. Counter-clockwise seen from outside.
struct MeshPart {
  int object = 0;                         // parts of one object of the file share the number; from 0, ascending
  std::vector<Eigen::Vector3f> vertices;  // in the shape's frame, scale applied [m]
  std::vector<Eigen::Vector3f> normals;   // one a vertex, unit length
  std::vector<Eigen::Vector2f> texture_coordinates;     // one a vertex, (0, 0) is the picture's lower left; empty: none
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of vertices
  std::optional<Eigen::Vector4f> color;    // the file's own: red, green, blue, opacity, 0 to 1; none: the shape's
  std::shared_ptr<const Texture> texture;  // null: none. Its pixels are multiplied with the colour
};

struct MeshData {
  std::string file;    // its real path
  std::string digest;  // of its bytes, then of the files it names (XXH3, 16 hexadecimal digits)
  std::vector<MeshPart> parts;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // corners of the box around all vertices, along the axes [m]
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();

  std::size_t triangle_count() const {
    std::size_t count = 0;
    for (const MeshPart& part : parts) count += part.triangles.size();
    return count;
  }
};

/// What contact takes an object of a mesh for.
struct ConvexHull {
  std::vector<Eigen::Vector3d> vertices;  // in the shape's frame [m]
  std::vector<std::vector<int>> faces;    // indices of vertices, flat polygons, counter-clockwise seen from outside
};

}  // namespace rehearse
