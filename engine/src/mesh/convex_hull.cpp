#include "convex_hull.h"

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "triangle_soup.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;
using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;  // directed: from a vertex to a vertex

/// For each object the vertices that its triangles use.
std::map<int, Points> points_of(const MeshData& mesh) {
  std::map<int, Points> objects;
  for (const MeshPart& part : mesh.parts) {
    Points& points = objects[part.object];
    points.reserve(points.size() + 3 * part.triangles.size());
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t vertex : triangle) points.push_back(part.vertices[vertex].cast<double>());
  }
  return objects;
}

double extent_along(const Points& points, const Vector3d& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vector3d& point : points) {
    low = std::min(low, point.dot(direction));
    high = std::max(high, point.dot(direction));
  }
  return high - low;
}

/// The extents of the points along three orthogonal axes, ascending.
struct Spread {
  Eigen::Matrix3d axes;  // columns, unit length
  Vector3d extents;      // [m]
};

Spread spread_of(const Points& points) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& point : points) middle += point / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3d& point : points) scatter += (point - middle) * (point - middle).transpose();
  Spread spread;
  spread.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  for (int i = 0; i < 3; ++i) spread.extents[i] = extent_along(points, spread.axes.col(i));
  return spread;
}

/// Two coordinates that differ by at most this much count as equal, because floats are rounded.
double rounding_of(const Points& points) {
  Vector3d low = points.front(), high = points.front();
  for (const Vector3d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double largest = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  return std::max(1e-6 * (high - low).norm(), 4.0 * std::numeric_limits<float>::epsilon() * largest);
}

/// True if each edge has a triangle on both of its sides: the surface is closed.
bool is_closed(const std::vector<Triangle>& triangles) {
  std::vector<Edge> edges, reversed;
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      edges.emplace_back(t[i], t[(i + 1) % 3]);
      reversed.emplace_back(t[(i + 1) % 3], t[i]);
    }
  }
  std::ranges::sort(edges);
  std::ranges::sort(reversed);
  return triangles.size() >= 4 && edges == reversed && std::ranges::adjacent_find(edges) == edges.end();
}

/// Qhull's state; the destructor frees its memory. (Its C++ classes aren't C++20.)
class Qhull {
 public:
  Qhull() : silence_(std::fopen("/dev/null", "w")) { qh_zero(&state_, silence_); }
  ~Qhull() {
    int blocks, bytes;
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &blocks, &bytes);
    if (silence_) std::fclose(silence_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// The triangles around the points; nullopt if Qhull failed.
  std::optional<std::vector<Triangle>> hull(const Points& points, std::string options) {
    std::vector<double> numbers;
    numbers.reserve(3 * points.size());
    for (const Vector3d& point : points) numbers.insert(numbers.end(), point.data(), point.data() + 3);
    options = "qhull Pp " + options;
    if (!silence_ || qh_new_qhull(&state_, 3, static_cast<int>(points.size()), numbers.data(), False, options.data(),
                                  nullptr, silence_) != 0)
      return std::nullopt;
    std::vector<Triangle> triangles;
    triangles.reserve(static_cast<std::size_t>(state_.num_facets));
    for (const facetT* facet = state_.facet_list; facet && facet->next; facet = facet->next) {
      if (qh_setsize(&state_, facet->vertices) != 3) return std::nullopt;
      Triangle triangle{};
      for (int i = 0; i < 3; ++i)
        triangle[i] = qh_pointid(&state_, static_cast<const vertexT*>(facet->vertices->e[i].p)->point);
      if (facet->toporient) std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
    }
    return triangles;
  }

 private:
  std::FILE* silence_;  // receives Qhull's messages, which are discarded
  qhT state_;
};

/// Six times the volume; negative if the triangles are wound inwards.
double volume(const Points& points, const std::vector<Triangle>& triangles) {
  double sum = 0.0;
  const Vector3d& origin = points[static_cast<std::size_t>(triangles.front()[0])];
  for (const Triangle& t : triangles)
    sum += (points[t[0]] - origin).dot((points[t[1]] - origin).cross(points[t[2]] - origin));
  return sum;
}

/// The triangles around the points, counter-clockwise seen from outside; nullopt if Qhull fails.
std::optional<std::vector<Triangle>> triangulated_hull(const Points& points) {
  // First try merged facets, cut into triangles. If the result isn't closed, try triangles of slightly displaced
  // points.
  for (const char* options : {"Qt", "QJ"}) {
    auto triangles = Qhull().hull(points, options);
    if (!triangles || !is_closed(*triangles)) continue;
    const double six_volumes = volume(points, *triangles);
    if (six_volumes == 0.0) continue;
    if (six_volumes < 0.0)
      for (Triangle& triangle : *triangles) std::swap(triangle[1], triangle[2]);
    return triangles;
  }
  return std::nullopt;
}

Vector3d area_vector(const Points& points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

/// The points that are vertices of the triangles, in the same order.
Points vertices_of(const Points& points, const std::vector<Triangle>& triangles) {
  std::vector<bool> used(points.size(), false);
  for (const Triangle& triangle : triangles)
    for (const int vertex : triangle) used[vertex] = true;
  Points vertices;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (used[i]) vertices.push_back(points[i]);
  return vertices;
}

/// A point outside a triangle's plane, and its distance from the plane [m]: at most its distance from the hull.
struct Outsider {
  std::size_t point = 0;
  double distance = 0.0;
};

/// For each triangle the point that is farthest outside its plane, sorted, the farthest first.
std::vector<Outsider> outsiders(const Points& points, const Points& of, const std::vector<Triangle>& triangles) {
  std::vector<Outsider> farthest(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3d normal = area_vector(of, triangles[t]).normalized();
    const double offset = normal.dot(of[triangles[t][0]]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = normal.dot(points[i]) - offset;
      if (distance > farthest[t].distance) farthest[t] = {i, distance};
    }
  }
  std::ranges::stable_sort(farthest, [](const Outsider& a, const Outsider& b) { return a.distance > b.distance; });
  return farthest;
}

struct Thinned {
  Points points;
  double error = 0.0;  // distance of the farthest left-out point from the hull [m]
};

/// Four points whose tetrahedron has a volume.
std::array<std::size_t, 4> tetrahedron_of(const Points& points) {
  const auto farthest = [&points](const auto& distance) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (distance(points[i]) > distance(points[best])) best = i;
    return best;
  };
  const Vector3d along = spread_of(points).axes.col(2);
  const std::size_t a = farthest([&](const Vector3d& point) { return -along.dot(point); });
  const std::size_t b = farthest([&](const Vector3d& point) { return along.dot(point); });
  const Vector3d line = (points[b] - points[a]).normalized();
  const std::size_t c = farthest([&](const Vector3d& point) { return line.cross(point - points[a]).norm(); });
  const Vector3d normal = line.cross(points[c] - points[a]).normalized();
  return {a, b, c, farthest([&](const Vector3d& point) { return std::abs(normal.dot(point - points[a])); })};
}

/// At most `max_hull_vertices` of the points, which are the vertices of their hull. Fewer if the other points are
/// outside by at most `rounding`.
std::optional<Thinned> thinned(const Points& points, double rounding) {
  std::vector<bool> chosen(points.size(), false);
  for (const std::size_t corner : tetrahedron_of(points)) chosen[corner] = true;
  for (;;) {
    Thinned kept;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (chosen[i]) kept.points.push_back(points[i]);
    const auto triangles = triangulated_hull(kept.points);
    if (!triangles) return std::nullopt;
    const std::vector<Outsider> left_out = outsiders(points, kept.points, *triangles);
    kept.error = left_out.front().distance;
    if (kept.points.size() >= max_hull_vertices || kept.error <= rounding) return kept;
    std::size_t wanted = std::min(1 + kept.points.size() / 10, max_hull_vertices - kept.points.size());
    for (const Outsider& outsider : left_out) {
      if (wanted == 0 || outsider.distance <= rounding) break;
      if (chosen[outsider.point]) continue;
      chosen[outsider.point] = true;
      --wanted;
    }
  }
}

/// Gathers triangles that lie in one plane.
class FaceMerger {
 public:
  FaceMerger(const Points& points, const std::vector<Triangle>& triangles, double tolerance)
      : points_(points), triangles_(triangles), tolerance_(tolerance), region_(triangles.size(), -1) {
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) sides_[{triangles[i][k], triangles[i][(k + 1) % 3]}] = static_cast<int>(i);
  }

  std::vector<std::vector<int>> faces() {
    std::vector<int> order;  // large ones first, because their planes are the most exact
    for (std::size_t i = 0; i < triangles_.size(); ++i) order.push_back(static_cast<int>(i));
    std::ranges::stable_sort(order, [this](int a, int b) {
      return area_vector(points_, triangles_[a]).squaredNorm() > area_vector(points_, triangles_[b]).squaredNorm();
    });
    std::vector<std::vector<int>> faces;
    for (const int seed : order) {
      if (region_[seed] >= 0) continue;
      const std::vector<int> members = grow(seed);
      if (auto outline = outline_of(members, seed)) {
        faces.push_back(std::move(*outline));
      } else {
        for (const int member : members) faces.emplace_back(triangles_[member].begin(), triangles_[member].end());
      }
    }
    return faces;
  }

 private:
  std::vector<int> grow(int seed) {
    const Vector3d normal = area_vector(points_, triangles_[seed]).normalized();
    const double offset = normal.dot(points_[triangles_[seed][0]]);
    std::vector<int> members{seed};
    region_[seed] = seed;
    for (std::size_t next = 0; next < members.size(); ++next) {
      const Triangle triangle = triangles_[members[next]];
      for (int k = 0; k < 3; ++k) {
        const int neighbour = sides_.at({triangle[(k + 1) % 3], triangle[k]});
        if (region_[neighbour] >= 0 || !lies_in(neighbour, normal, offset)) continue;
        region_[neighbour] = seed;
        members.push_back(neighbour);
      }
    }
    return members;
  }

  bool lies_in(int triangle, const Vector3d& normal, double offset) const {
    const Vector3d area = area_vector(points_, triangles_[triangle]);
    if (area.dot(normal) < 0.0) return false;
    return std::ranges::all_of(
        triangles_[triangle], [&](int vertex) { return std::abs(normal.dot(points_[vertex]) - offset) <= tolerance_; });
  }

  /// The polygon around the triangles of a region; empty if the region has no single outline.
  std::optional<std::vector<int>> outline_of(const std::vector<int>& members, int seed) const {
    std::map<int, int> next;
    for (const int member : members) {
      for (int k = 0; k < 3; ++k) {
        const int from = triangles_[member][k], to = triangles_[member][(k + 1) % 3];
        if (region_[sides_.at({to, from})] == seed) continue;
        if (!next.emplace(from, to).second) return std::nullopt;
      }
    }
    if (next.empty()) return std::nullopt;
    std::vector<int> outline{next.begin()->first};
    while (next.at(outline.back()) != outline.front()) {
      outline.push_back(next.at(outline.back()));
      if (outline.size() > next.size()) return std::nullopt;
    }
    if (outline.size() != next.size()) return std::nullopt;
    return outline;
  }

  const Points& points_;
  const std::vector<Triangle>& triangles_;
  double tolerance_;
  std::vector<int> region_;    // by triangle: the first of its region; -1: not assigned yet
  std::map<Edge, int> sides_;  // the triangle on the left of an edge
};

/// Removes vertices at which only two faces meet: they are in the middle of an edge.
void straighten(std::vector<std::vector<int>>& faces, std::size_t count) {
  std::vector<int> meeting(count, 0);
  for (const auto& face : faces)
    for (const int vertex : face) ++meeting[vertex];
  for (auto& face : faces)
    face.erase(std::remove_if(face.begin(), face.end(), [&](int vertex) { return meeting[vertex] < 3; }), face.end());
}

ConvexHull numbered(const Points& points, std::vector<std::vector<int>> faces) {
  std::vector<int> numbers(points.size(), -1);
  for (const auto& face : faces)
    for (const int vertex : face) numbers[vertex] = 0;
  ConvexHull hull;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (numbers[i] < 0) continue;
    numbers[i] = static_cast<int>(hull.vertices.size());
    hull.vertices.push_back(points[i]);
  }
  for (auto& face : faces) {
    for (int& vertex : face) vertex = numbers[vertex];
    std::rotate(face.begin(), std::ranges::min_element(face), face.end());
  }
  std::ranges::sort(faces);
  hull.faces = std::move(faces);
  return hull;
}

ConvexHull merged(const Points& points, const std::vector<Triangle>& triangles, double tolerance) {
  std::vector<std::vector<int>> faces = FaceMerger(points, triangles, tolerance).faces();
  straighten(faces, points.size());
  if (faces.size() >= 4 && std::ranges::all_of(faces, [](const auto& face) { return face.size() >= 3; }))
    return numbered(points, std::move(faces));
  faces.clear();
  for (const Triangle& triangle : triangles) faces.emplace_back(triangle.begin(), triangle.end());
  return numbered(points, std::move(faces));
}

class HullMaker {
 public:
  HullMaker(const std::string& object, Diagnostics& remarks) : object_(object), remarks_(remarks) {}

  /// `volume_of_all`: gets the volume of the hull of all points, unless they are moved; null: it isn't wanted.
  Result<ConvexHull> make(Points points, std::optional<double>* volume_of_all = nullptr) {
    if (points.empty()) return error(object_ + "has no triangles");
    if (!std::ranges::all_of(points, [](const Vector3d& point) { return point.allFinite(); }))
      return error(object_ + "has a vertex that is not finite");
    const Spread spread = spread_of(points);
    constexpr double flat = 1e-5;  // share of the size
    if (spread.extents[1] <= flat * spread.extents[2])
      return error(object_ + (spread.extents[2] == 0.0 ? "is a single point" : "is a line") + " and can't be touched",
                   "take a sphere or a box for its collision");
    const bool is_flat = spread.extents[0] <= flat * spread.extents[2];
    if (is_flat) thicken(points, spread.axes.col(0));
    const double rounding = rounding_of(points);
    auto triangles = triangulated_hull(points);
    if (triangles) {
      if (volume_of_all && !is_flat) *volume_of_all = volume(points, *triangles) / 6.0;
      points = vertices_of(points, *triangles);
      if (points.size() > max_hull_vertices && !thin(points, rounding)) return no_hull();
      triangles = triangulated_hull(points);
    }
    if (!triangles) return no_hull();
    return merged(points, *triangles, rounding);
  }

 private:
  void remark(Severity severity, std::string message, std::string hint) {
    Diagnostic remark = error(object_ + std::move(message), std::move(hint));
    remark.severity = severity;
    remarks_.push_back(std::move(remark));
  }

  Diagnostic no_hull() const {
    return error(object_ + "has no convex hull that could be computed", "take simple shapes for its collision");
  }

  void thicken(Points& points, const Vector3d& normal) {
    Points both;
    for (const Vector3d& point : points)
      for (const double side : {-0.5, 0.5}) both.push_back(point + side * sheet_thickness * normal);
    points = std::move(both);
    std::ranges::sort(points, before);
    remark(Severity::warning, fmt::format("is flat: contact takes it to be {} mm thick", 1e3 * sheet_thickness),
           "take a box for its collision");
  }

  bool thin(Points& points, double rounding) {
    auto fewer = thinned(points, rounding);
    if (!fewer) return false;
    if (fewer->error > rounding) tell_thinned(points, *fewer);
    points = std::move(fewer->points);
    return true;
  }

  void tell_thinned(const Points& points, const Thinned& fewer) {
    // a note, not a warning: most meshes of real robots are finer than contacts need
    remark(Severity::note,
           fmt::format("has a hull of {} vertices: contact takes {} of them; the others are up to {:.2g} mm outside "
                       "their hull",
                       points.size(), fewer.points.size(), 1e3 * fewer.error),
           "take a simpler mesh, or simple shapes, for its collision");
  }

  std::string object_;
  Diagnostics& remarks_;
};

/// Sorts the points, and leaves each position once.
void sort_points(Points& points) {
  std::ranges::sort(points, before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  points.shrink_to_fit();  // six triangles share a vertex of a closed mesh
}

}  // namespace

std::vector<std::pair<int, std::string>> objects_of(const MeshData& mesh) {
  std::set<int> numbers;
  for (const MeshPart& part : mesh.parts) numbers.insert(part.object);
  std::vector<std::pair<int, std::string>> objects;
  for (const int number : numbers)
    objects.emplace_back(number, numbers.size() > 1 ? fmt::format("object {} ", number) : "it ");
  return objects;
}

Result<ConvexHulls> convex_hulls(const MeshData& mesh, std::map<int, double>* volumes) {
  ConvexHulls result;
  std::map<int, Points> points = points_of(mesh);
  if (points.empty()) return error("it has no triangles");
  for (const auto& [number, name] : objects_of(mesh)) {
    Points& of_object = points.at(number);
    sort_points(of_object);
    std::optional<double> volume_of_all;
    auto hull = REHEARSE_TRY(HullMaker(name, result.remarks).make(std::move(of_object), &volume_of_all));
    result.hulls.push_back(std::move(hull));
    if (volumes && volume_of_all) volumes->emplace(number, *volume_of_all);
  }
  return result;
}

Result<ConvexHull> convex_hull(Points points, const std::string& object, Diagnostics& remarks) {
  sort_points(points);
  return HullMaker(object, remarks).make(std::move(points));
}

double hull_volume(Points points) {
  sort_points(points);
  if (points.size() < 4) return 0.0;
  const auto triangles = triangulated_hull(points);
  return triangles ? volume(points, *triangles) / 6.0 : 0.0;
}

double volume(const ConvexHull& hull) {
  std::vector<Triangle> triangles;
  for (const std::vector<int>& face : hull.faces)
    for (std::size_t i = 1; i + 1 < face.size(); ++i) triangles.push_back({face[0], face[i], face[i + 1]});
  return volume(hull.vertices, triangles) / 6.0;
}

}  // namespace rehearse
