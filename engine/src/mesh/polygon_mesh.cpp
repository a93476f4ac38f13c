#define XXH_INLINE_ALL
#include "polygon_mesh.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace rehearse {
namespace {

using Polygon = std::vector<int>;

/// Twice the area of a polygon, along its normal (Newell's method).
Eigen::Vector3d area_of(const std::vector<Eigen::Vector3d>& vertices, const Polygon& polygon) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = vertices[static_cast<std::size_t>(polygon[0])];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    area += (vertices[static_cast<std::size_t>(polygon[i])] - origin)
                .cross(vertices[static_cast<std::size_t>(polygon[i + 1])] - origin);
  return area;
}

/// Cuts a polygon into triangles. They are corners of the polygon, by their place in it.
class EarCutter {
 public:
  EarCutter(const std::vector<Eigen::Vector3d>& vertices, const Polygon& polygon, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d across = normal.unitOrthogonal();
    const Eigen::Vector3d up = normal.cross(across);
    for (const int i : polygon) {
      const Eigen::Vector3d& vertex = vertices[static_cast<std::size_t>(i)];
      points_.emplace_back(across.dot(vertex), up.dot(vertex));
    }
  }

  std::vector<std::array<int, 3>> cut() {
    std::vector<std::array<int, 3>> triangles;
    std::vector<int> left(points_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
    while (left.size() > 3) {
      const std::size_t ear = find_ear(left);
      triangles.push_back(corner(left, ear));
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({left[0], left[1], left[2]});
    return triangles;
  }

 private:
  static std::array<int, 3> corner(const std::vector<int>& left, std::size_t i) {
    const std::size_t n = left.size();
    return {left[(i + n - 1) % n], left[i], left[(i + 1) % n]};
  }

  double turn(int a, int b, int c) const {
    const Eigen::Vector2d ab = at(b) - at(a), ac = at(c) - at(a);
    return ab.x() * ac.y() - ab.y() * ac.x();
  }
  const Eigen::Vector2d& at(int i) const { return points_[static_cast<std::size_t>(i)]; }

  /// The first corner that turns left and contains no other; the first of all if the polygon crosses itself.
  std::size_t find_ear(const std::vector<int>& left) const {
    for (std::size_t i = 0; i < left.size(); ++i) {
      const auto [a, b, c] = corner(left, i);
      if (turn(a, b, c) <= 0.0) continue;
      const bool is_ear = std::ranges::none_of(left, [&, a = a, b = b, c = c](int other) {
        if (other == a || other == b || other == c) return false;
        return turn(a, b, other) >= 0.0 && turn(b, c, other) >= 0.0 && turn(c, a, other) >= 0.0;
      });
      if (is_ear) return i;
    }
    return 0;
  }

  std::vector<Eigen::Vector2d> points_;
};

struct Corner {
  int vertex;
  int texture;  // -1: none
  std::size_t face;
};

/// The normal at a corner: that of its face, and of the faces at the same vertex that meet it at less than the crease.
Eigen::Vector3d normal_at(const Corner& corner, const std::vector<std::vector<std::size_t>>& faces_of_vertex,
                          const std::vector<Eigen::Vector3d>& areas, double crease) {
  const Eigen::Vector3d own = areas[corner.face].stableNormalized();
  if (crease <= 0.0) return own;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double least = std::cos(std::min(crease, 3.14159));
  for (const std::size_t face : faces_of_vertex[static_cast<std::size_t>(corner.vertex)])
    if (own.dot(areas[face].stableNormalized()) >= least - 1e-9) sum += areas[face].stableNormalized();
  return sum.isZero(1e-9) ? own : Eigen::Vector3d(sum.stableNormalized());
}

std::optional<Diagnostic> check(const PolygonMesh& polygons) {
  const auto in_range = [](const std::vector<std::vector<int>>& faces, std::size_t count) {
    return std::ranges::all_of(faces, [count](const Polygon& face) {
      return std::ranges::all_of(face, [count](int i) { return i >= 0 && static_cast<std::size_t>(i) < count; });
    });
  };
  if (!in_range(polygons.faces, polygons.vertices.size()))
    return error(fmt::format("a face refers to a vertex that isn't there; there are {}", polygons.vertices.size()));
  if (!in_range(polygons.texture_faces, polygons.texture_coordinates.size()))
    return error("a face refers to a texture coordinate that isn't there");
  return std::nullopt;
}

/// Collects the vertices of a part, each once per normal and texture coordinate.
class PartBuilder {
 public:
  PartBuilder(const PolygonMesh& polygons, std::vector<Eigen::Vector3d> vertices)
      : polygons_(polygons), vertices_(std::move(vertices)) {}

  std::uint32_t add(const Corner& corner, const Eigen::Vector3d& normal) {
    const Eigen::Vector3f n = normal.cast<float>();
    const auto [known, is_new] = known_.emplace(std::tuple(corner.vertex, corner.texture, n.x(), n.y(), n.z()),
                                                static_cast<std::uint32_t>(part.vertices.size()));
    if (!is_new) return known->second;
    part.vertices.push_back(vertices_[static_cast<std::size_t>(corner.vertex)].cast<float>());
    part.normals.push_back(n);
    if (corner.texture >= 0)
      part.texture_coordinates.push_back(
          polygons_.texture_coordinates[static_cast<std::size_t>(corner.texture)].cast<float>());
    return known->second;
  }

  MeshPart part;

 private:
  const PolygonMesh& polygons_;
  std::vector<Eigen::Vector3d> vertices_;
  std::map<std::tuple<int, int, float, float, float>, std::uint32_t> known_;
};

}  // namespace

Result<MeshPart> part_of(const PolygonMesh& polygons, const Eigen::Affine3d& place) {
  if (auto problem = check(polygons)) return *problem;
  std::vector<Eigen::Vector3d> vertices;
  for (const Eigen::Vector3d& vertex : polygons.vertices) vertices.push_back(place * vertex);
  const auto is_finite = [](const Eigen::Vector3d& vertex) { return vertex.cast<float>().allFinite(); };
  if (!std::ranges::all_of(vertices, is_finite)) return error("a vertex isn't finite");
  const bool is_mirrored = place.linear().determinant() < 0.0;
  const bool has_texture = polygons.texture_faces.size() == polygons.faces.size() && !polygons.faces.empty();
  std::vector<Eigen::Vector3d> areas;
  std::vector<std::vector<std::size_t>> faces_of_vertex(vertices.size());
  for (std::size_t i = 0; i < polygons.faces.size(); ++i) {
    const Polygon& face = polygons.faces[i];
    areas.push_back(face.size() < 3 ? Eigen::Vector3d(0, 0, 0) : area_of(vertices, face) * (is_mirrored ? -1.0 : 1.0));
    for (const int vertex : face) faces_of_vertex[static_cast<std::size_t>(vertex)].push_back(i);
  }
  PartBuilder builder(polygons, vertices);
  for (std::size_t i = 0; i < polygons.faces.size(); ++i) {
    const Polygon& face = polygons.faces[i];
    if (!(areas[i].norm() > 0.0)) continue;
    const bool fits = has_texture && polygons.texture_faces[i].size() == face.size();
    EarCutter cutter(vertices, face, (is_mirrored ? -areas[i] : areas[i]).stableNormalized());
    for (const std::array<int, 3>& ear : cutter.cut()) {
      std::array<std::uint32_t, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(ear[k]);
        const Corner corner{face[at], fits ? polygons.texture_faces[i][at] : -1, i};
        triangle[k] = builder.add(corner, normal_at(corner, faces_of_vertex, areas, polygons.crease_angle));
      }
      if (is_mirrored) std::swap(triangle[1], triangle[2]);
      builder.part.triangles.push_back(triangle);
    }
  }
  if (builder.part.triangles.empty()) return error("it has no triangles");
  if (builder.part.texture_coordinates.size() != builder.part.vertices.size()) builder.part.texture_coordinates.clear();
  return std::move(builder.part);
}

std::shared_ptr<const MeshData> mesh_of(std::vector<MeshPart> parts) {
  auto data = std::make_shared<MeshData>();
  Eigen::AlignedBox<float, 3> box;
  std::uint64_t hash = 0;
  for (const MeshPart& part : parts) {
    for (const Eigen::Vector3f& vertex : part.vertices) {
      box.extend(vertex);
      hash = XXH3_64bits_withSeed(vertex.data(), 3 * sizeof(float), hash);
    }
    hash = XXH3_64bits_withSeed(part.triangles.data(), part.triangles.size() * sizeof part.triangles[0], hash);
  }
  data->parts = std::move(parts);
  data->digest = fmt::format("{:016x}", hash);
  data->lower = box.min().cast<double>();
  data->upper = box.max().cast<double>();
  return data;
}

}  // namespace rehearse
