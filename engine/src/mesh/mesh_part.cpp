#include "mesh_part.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <utility>

#include "base/names.h"
#include "base/text.h"

namespace rehearse {
namespace {

/// True if each triangle has separate vertices, in the order of the triangles, as in an STL.
bool is_flat(const MeshPart& part) {
  if (part.vertices.size() != 3 * part.triangles.size()) return false;
  std::uint32_t next = 0;
  for (const std::array<std::uint32_t, 3>& triangle : part.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner != next++) return false;
  return true;
}

}  // namespace

MeshMatrix product(const MeshMatrix& outer, const MeshMatrix& inner) {
  MeshMatrix product = outer.leftCols<3>() * inner;
  product.col(3) += outer.col(3);
  return product;
}

MeshMatrix placing_of(MeshFormat format, const Eigen::Vector3d& scale, bool z_up) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (!z_up && (format == MeshFormat::gltf || format == MeshFormat::glb)) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  MeshMatrix placing = MeshMatrix::Zero();
  placing.leftCols<3>() = scale.asDiagonal() * turn;
  return placing;
}

bool add_vertex(const MeshMatrix& place, const Eigen::Vector3d& of_file, MeshPart& part) {
  const Eigen::Vector3d vertex = place.leftCols<3>() * of_file + place.col(3);
  part.vertices.emplace_back(vertex.cast<float>());
  return part.vertices.back().allFinite();
}

Diagnostic not_finite() { return error("a vertex of it isn't finite"); }

bool mirrors(const MeshMatrix& place) { return place.leftCols<3>().determinant() < 0.0; }

Eigen::Vector3f normal_of(const MeshPart& part, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3d a = part.vertices[triangle[0]].cast<double>();
  const Eigen::Vector3d b = part.vertices[triangle[1]].cast<double>();
  const Eigen::Vector3d c = part.vertices[triangle[2]].cast<double>();
  const Eigen::Vector3d normal = (b - a).cross(c - a).stableNormalized();
  return normal.squaredNorm() > 0.5 ? Eigen::Vector3f(normal.cast<float>()) : Eigen::Vector3f::UnitZ();
}

void flatten(MeshPart& part) {
  const std::size_t corners = 3 * part.triangles.size();
  if (is_flat(part)) {
    part.normals.reserve(corners);
    for (const std::array<std::uint32_t, 3>& triangle : part.triangles)
      part.normals.insert(part.normals.end(), 3, normal_of(part, triangle));
    return;
  }
  MeshPart flat;
  flat.vertices.reserve(corners);
  flat.normals.reserve(corners);
  for (std::array<std::uint32_t, 3>& triangle : part.triangles) {
    const Eigen::Vector3f normal = normal_of(part, triangle);
    for (std::uint32_t& corner : triangle) {
      flat.vertices.push_back(part.vertices[corner]);
      flat.normals.push_back(normal);
      if (!part.texture_coordinates.empty()) flat.texture_coordinates.push_back(part.texture_coordinates[corner]);
      corner = static_cast<std::uint32_t>(flat.vertices.size() - 1);
    }
  }
  part.vertices = std::move(flat.vertices);
  part.normals = std::move(flat.normals);
  part.texture_coordinates = std::move(flat.texture_coordinates);
}

Diagnostic no_such_node(const std::string& wanted, const std::vector<std::string>& names) {
  constexpr std::size_t most = 20;
  return error(fmt::format("it has no node {}", in_quotes(wanted)),
               names.empty() ? "none of its nodes has a name" : "its nodes: " + listed(names, most));
}

Result<std::vector<MeshPart>> read_binary_stl(const std::string& bytes, const Eigen::Vector3d& scale, bool z_up) {
  constexpr std::size_t normal = 12, corner = 12, attributes = 2;  // of a triangle [bytes]
  const MeshMatrix root = MeshMatrix::Identity();                  // assimp's node without a transform
  const MeshMatrix place = product(product(placing_of(MeshFormat::stl, scale, z_up), root), root);
  const std::size_t count = (bytes.size() - stl_head) / stl_triangle;
  std::vector<MeshPart> parts(1);
  MeshPart& part = parts.front();
  const bool mirrors_all = mirrors(place);
  part.vertices.reserve(3 * count);
  part.triangles.reserve(count);
  const char* next = bytes.data() + stl_head;
  for (std::uint32_t i = 0; i < count; ++i, next += attributes) {
    next += normal;
    for (int k = 0; k < 3; ++k, next += corner) {
      Eigen::Vector3f vertex;
      std::memcpy(vertex.data(), next, corner);
      if (!add_vertex(place, vertex.cast<double>(), part)) return not_finite();
    }
    const std::uint32_t first = 3 * i;
    part.triangles.push_back({first, first + 1, first + 2});
    if (mirrors_all) std::swap(part.triangles.back()[1], part.triangles.back()[2]);
  }
  flatten(part);
  return parts;
}

}  // namespace rehearse
