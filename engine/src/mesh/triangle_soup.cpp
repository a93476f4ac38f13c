#include "triangle_soup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace rehearse {
namespace {

using Eigen::Vector3d;

bool has_three_corners(const std::array<int, 3>& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

/// Connected vertices: of each the lowest number that is connected to it.
class Leaders {
 public:
  explicit Leaders(std::size_t count) : leaders_(count) { std::iota(leaders_.begin(), leaders_.end(), 0); }

  int of(int vertex) {
    int& leader = at(vertex);
    while (leader != at(leader)) leader = at(leader);
    return leader;
  }
  void connect(int a, int b) {
    const int leader_a = of(a), leader_b = of(b);
    at(std::max(leader_a, leader_b)) = std::min(leader_a, leader_b);
  }

 private:
  int& at(int vertex) { return leaders_[static_cast<std::size_t>(vertex)]; }

  std::vector<int> leaders_;
};

/// A corner of a polygon on one side of a cut: a vertex of the soup (then both numbers are its own), or the point where
/// an edge between two vertices, the lower number first, crosses the plane.
struct SoupCorner {
  std::pair<int, int> between;
  bool in_plane;
};

/// One side of a cut.
class Side {
 public:
  Side(const TriangleSoup& whole, const std::vector<double>& heights, TriangleSoup& soup)
      : whole_(whole), heights_(heights), soup_(soup), numbers_(whole.vertices.size(), -1) {}

  /// Adds a flat polygon.
  void add(const std::vector<SoupCorner>& polygon) {
    std::vector<int> numbers;
    for (const SoupCorner& corner : polygon) numbers.push_back(number_of(corner.between));
    for (std::size_t i = 1; i + 1 < numbers.size(); ++i) add({numbers[0], numbers[i], numbers[i + 1]});
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::size_t next = (i + 1) % numbers.size();
      if (polygon[i].in_plane && polygon[next].in_plane) section_.push_back({numbers[next], numbers[i]});
    }
  }
  /// Closes the side in the plane: a fan of triangles over each connected outline of the section, from its first point.
  void close() {
    Leaders leaders(soup_.vertices.size());
    for (const auto& [from, to] : section_) leaders.connect(from, to);
    for (const auto& [from, to] : section_) add({leaders.of(from), from, to});
  }

 private:
  void add(const std::array<int, 3>& triangle) {
    if (has_three_corners(triangle)) soup_.triangles.push_back(triangle);
  }

  int number_of(const std::pair<int, int>& between) {
    const auto a = static_cast<std::size_t>(between.first), b = static_cast<std::size_t>(between.second);
    int& number = a == b ? numbers_[a] : crossings_.emplace(between, -1).first->second;
    if (number >= 0) return number;
    number = static_cast<int>(soup_.vertices.size());
    const Vector3d &from = whole_.vertices[a], &to = whole_.vertices[b];
    soup_.vertices.push_back(a == b ? from : Vector3d(from + heights_[a] / (heights_[a] - heights_[b]) * (to - from)));
    return number;
  }

  const TriangleSoup& whole_;
  const std::vector<double>& heights_;  // of its vertices above the plane [m]
  TriangleSoup& soup_;
  std::vector<int> numbers_;                      // by vertex of the whole; -1: not on this side
  std::map<std::pair<int, int>, int> crossings_;  // by edge
  std::vector<std::pair<int, int>> section_;      // outline, directed
};

/// True if the triangle faces in that direction.
bool faces(const TriangleSoup& soup, const std::array<int, 3>& triangle, const Vector3d& direction) {
  const auto at = [&](std::size_t i) { return soup.vertices[static_cast<std::size_t>(triangle[i])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(direction) > 0.0;
}

/// The soup without vertices that no triangle uses.
TriangleSoup without_unused(const TriangleSoup& soup) {
  std::vector<int> numbers(soup.vertices.size(), -1);
  TriangleSoup used;
  for (std::array<int, 3> triangle : soup.triangles) {
    for (int& corner : triangle) {
      int& number = numbers[static_cast<std::size_t>(corner)];
      if (number < 0) {
        number = static_cast<int>(used.vertices.size());
        used.vertices.push_back(soup.vertices[static_cast<std::size_t>(corner)]);
      }
      corner = number;
    }
    used.triangles.push_back(triangle);
  }
  return used;
}

}  // namespace

TriangleSoup object_of(const MeshData& mesh, int object) {
  TriangleSoup soup;
  for (const MeshPart& part : mesh.parts) {
    if (part.object != object) continue;
    soup.vertices.reserve(soup.vertices.size() + part.vertices.size());
    for (const Eigen::Vector3f& vertex : part.vertices) soup.vertices.push_back(vertex.cast<double>());
  }
  std::ranges::stable_sort(soup.vertices, before);
  soup.vertices.erase(std::unique(soup.vertices.begin(), soup.vertices.end()), soup.vertices.end());
  soup.vertices.shrink_to_fit();  // six triangles share a vertex of a closed mesh
  for (const MeshPart& part : mesh.parts) {
    if (part.object != object) continue;
    std::vector<int> numbers;
    numbers.reserve(part.vertices.size());
    soup.triangles.reserve(soup.triangles.size() + part.triangles.size());
    for (const Eigen::Vector3f& vertex : part.vertices)
      numbers.push_back(static_cast<int>(
          std::lower_bound(soup.vertices.begin(), soup.vertices.end(), vertex.cast<double>().eval(), before) -
          soup.vertices.begin()));
    for (const auto& [a, b, c] : part.triangles)
      if (const std::array<int, 3> triangle{numbers[a], numbers[b], numbers[c]}; has_three_corners(triangle))
        soup.triangles.push_back(triangle);
  }
  return without_unused(soup);
}

TriangleSoup coarsened(const TriangleSoup& soup, int cells) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : soup.vertices) box.extend(vertex);
  const double cell = box.sizes().maxCoeff() / cells;
  if (!(cell > 0.0)) return soup;
  const auto farther = [middle = box.center()](const Vector3d& a, const Vector3d& b) {
    return (a - middle).squaredNorm() > (b - middle).squaredNorm();
  };
  const auto cell_of = [&](const Vector3d& vertex) {
    const Vector3d place = (vertex - box.min()) / cell;
    return std::array<int, 3>{static_cast<int>(place.x()), static_cast<int>(place.y()), static_cast<int>(place.z())};
  };
  std::map<std::array<int, 3>, int> kept;  // by cell: the vertex farthest from the middle
  std::vector<int> numbers;
  TriangleSoup coarse;
  for (const Vector3d& vertex : soup.vertices) {
    const auto [known, is_new] = kept.emplace(cell_of(vertex), static_cast<int>(coarse.vertices.size()));
    numbers.push_back(known->second);
    if (is_new) coarse.vertices.push_back(vertex);
    Vector3d& stays = coarse.vertices[static_cast<std::size_t>(known->second)];
    if (farther(vertex, stays)) stays = vertex;
  }
  for (const auto& [a, b, c] : soup.triangles) {
    const auto number = [&numbers](int vertex) { return numbers[static_cast<std::size_t>(vertex)]; };
    std::array<int, 3> corners{number(a), number(b), number(c)};
    if (!has_three_corners(corners)) continue;
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    coarse.triangles.push_back(corners);
  }
  std::ranges::sort(coarse.triangles);
  coarse.triangles.erase(std::unique(coarse.triangles.begin(), coarse.triangles.end()), coarse.triangles.end());
  return without_unused(coarse);
}

std::vector<TriangleSoup> separate_parts(const TriangleSoup& soup, std::size_t most) {
  Leaders leaders(soup.vertices.size());
  for (const std::array<int, 3>& triangle : soup.triangles) {
    leaders.connect(triangle[0], triangle[1]);
    leaders.connect(triangle[0], triangle[2]);
  }
  std::map<int, std::size_t> numbers;  // of parts, by leader
  std::vector<TriangleSoup> parts;
  for (const std::array<int, 3>& triangle : soup.triangles) {
    const auto [known, is_new] = numbers.emplace(leaders.of(triangle[0]), parts.size());
    if (is_new && parts.size() == most) return {soup};
    if (is_new) parts.emplace_back();
    parts[known->second].triangles.push_back(triangle);
  }
  if (parts.size() < 2) return {soup};
  for (TriangleSoup& part : parts) part = without_unused({soup.vertices, std::move(part.triangles)});
  return parts;
}

bool is_closed(const TriangleSoup& soup) {
  std::vector<std::pair<int, int>> edges, reversed;
  for (const std::array<int, 3>& t : soup.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges.emplace_back(t[i], t[(i + 1) % 3]);
      reversed.emplace_back(t[(i + 1) % 3], t[i]);
    }
  }
  std::ranges::sort(edges);
  std::ranges::sort(reversed);
  return edges == reversed;
}

double volume(const TriangleSoup& soup) {
  if (soup.vertices.empty()) return 0.0;
  double six_volumes = 0.0;
  const auto at = [&](int vertex) -> Vector3d {
    return soup.vertices[static_cast<std::size_t>(vertex)] - soup.vertices.front();
  };
  for (const auto& [a, b, c] : soup.triangles) six_volumes += at(a).dot(at(b).cross(at(c)));
  return six_volumes / 6.0;
}

std::pair<TriangleSoup, TriangleSoup> cut(const TriangleSoup& soup, const CutPlane& plane, double tolerance) {
  std::vector<double> heights;
  heights.reserve(soup.vertices.size());
  for (const Vector3d& vertex : soup.vertices) {
    const double height = plane.normal.dot(vertex) - plane.offset;
    heights.push_back(std::abs(height) <= tolerance ? 0.0 : height);
  }
  std::pair<TriangleSoup, TriangleSoup> sides;
  Side behind(soup, heights, sides.first), ahead(soup, heights, sides.second);
  std::vector<SoupCorner> polygon;
  for (const std::array<int, 3>& triangle : soup.triangles) {
    const auto height = [&](std::size_t i) { return heights[static_cast<std::size_t>(triangle[i])]; };
    const bool lies_in_plane = height(0) == 0.0 && height(1) == 0.0 && height(2) == 0.0;
    for (const double sign : {-1.0, 1.0}) {  // behind the plane, ahead of it
      if (lies_in_plane && faces(soup, triangle, plane.normal) != (sign < 0.0))
        continue;  // a solid is behind its faces
      polygon.clear();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        if (sign * height(i) >= 0.0) polygon.push_back({{triangle[i], triangle[i]}, height(i) == 0.0});
        if (height(i) * height(next) < 0.0) polygon.push_back({std::minmax(triangle[i], triangle[next]), true});
      }
      if (polygon.size() >= 3) (sign < 0.0 ? behind : ahead).add(polygon);
    }
  }
  behind.close();
  ahead.close();
  return sides;
}

}  // namespace rehearse
