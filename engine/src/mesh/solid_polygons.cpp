// The polygons of solids.
#include "polygon_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rehearse {
namespace {

/// Rings of points about the y axis, from the top down, and the faces between them. A radius of 0 is a tip; flat ends
/// are closed.
PolygonMesh turned(const std::vector<Eigen::Vector2d>& profile, int divisions) {
  PolygonMesh mesh;
  std::vector<std::vector<int>> rings;
  for (const Eigen::Vector2d& point : profile) {  // radius, height
    std::vector<int>& ring = rings.emplace_back();
    const int count = point.x() > 0.0 ? divisions : 1;
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / divisions;
      ring.push_back(static_cast<int>(mesh.vertices.size()));
      mesh.vertices.emplace_back(point.x() * std::sin(angle), point.y(), point.x() * std::cos(angle));
    }
  }
  if (rings.front().size() > 1) mesh.faces.push_back(rings.front());
  for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
    const std::vector<int>&above = rings[r], &below = rings[r + 1];
    for (int i = 0; i < divisions; ++i) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>((i + 1) % divisions);
      if (above.size() == 1)
        mesh.faces.push_back({above[0], below[a], below[b]});
      else if (below.size() == 1)
        mesh.faces.push_back({above[a], below[0], above[b]});
      else
        mesh.faces.push_back({above[a], below[a], below[b], above[b]});
    }
  }
  if (rings.back().size() > 1) mesh.faces.emplace_back(rings.back().rbegin(), rings.back().rend());
  mesh.crease_angle = 1.0;
  return mesh;
}

/// Points of a half circle from its top, about a centre at `height`: those above the equator, or those from it down.
void add_cap(double radius, double height, int divisions, bool is_top, std::vector<Eigen::Vector2d>& profile) {
  const int steps = std::max(2, divisions / 4);
  for (int i = 0; i <= steps; ++i) {
    const double angle = std::numbers::pi / 2.0 * (is_top ? steps - i : -i) / steps;
    const bool is_tip = (is_top && i == 0) || (!is_top && i == steps);
    profile.emplace_back(is_tip ? 0.0 : radius * std::cos(angle), height + radius * std::sin(angle));
  }
}

/// The axes at a point of the spine as columns: x and z of the section, y along the spine.
class SpineFrames {
 public:
  SpineFrames(const std::vector<Eigen::Vector3d>& spine, std::size_t count, bool is_closed)
      : spine_(spine), count_(count), is_closed_(is_closed) {
    if (count < 3) return;
    for (std::size_t i = 0; i < count; ++i) normals_.push_back(bend_at(i));
    std::size_t first = 0;
    while (first < count && normals_[first].norm() == 0.0) ++first;
    is_straight_ = first == count;
    for (std::size_t i = 0; i < count && !is_straight_; ++i) {
      if (i < first) normals_[i] = normals_[first];
      if (normals_[i].norm() == 0.0) normals_[i] = normals_[i - 1];
      if (i > 0 && normals_[i].dot(normals_[i - 1]) < 0.0) normals_[i] *= -1.0;
    }
  }

  Eigen::Matrix3d at(std::size_t i) const {
    const Eigen::Vector3d y = along(i).stableNormalized();
    if (is_straight_) {
      // Choreonoid turns +y onto the spine about an axis that it doesn't normalise: along -y the axis is zero, and the
      // rotation formula leaves cos(pi) = -1 on the diagonal; an oblique spine shears the section.
      return Eigen::AngleAxisd(std::acos(std::clamp(y.y(), -1.0, 1.0)), Eigen::Vector3d(y.z(), 0.0, -y.x()))
          .toRotationMatrix();
    }
    const Eigen::Vector3d z = normals_[i].stableNormalized();
    return (Eigen::Matrix3d() << y.cross(z), y, z).finished();
  }

 private:
  const Eigen::Vector3d& point(std::size_t i) const { return spine_[i % count_]; }
  std::size_t middle(std::size_t i) const {
    return is_closed_ ? i + count_ : std::clamp<std::size_t>(i, 1, count_ - 2);
  }
  Eigen::Vector3d bend_at(std::size_t i) const {
    const std::size_t m = middle(i);
    return (point(m + 1) - point(m)).cross(point(m - 1) - point(m));
  }
  Eigen::Vector3d along(std::size_t i) const {
    if (count_ == 2) return spine_[1] - spine_[0];
    if (is_closed_) return point(i + 1) - point(i + count_ - 1);
    if (i == 0) return spine_[1] - spine_[0];
    if (i == count_ - 1) return spine_[i] - spine_[i - 1];
    return spine_[i + 1] - spine_[i - 1];
  }

  const std::vector<Eigen::Vector3d>& spine_;
  std::size_t count_;
  bool is_closed_;
  bool is_straight_ = true;
  std::vector<Eigen::Vector3d> normals_;
};

/// The value for a point of the spine: one for all, or one each.
template <class Value>
Value one_of(const std::vector<Value>& values, std::size_t i, const Value& otherwise) {
  if (values.empty()) return otherwise;
  return values.size() == 1 ? values[0] : values[std::min(i, values.size() - 1)];
}

}  // namespace

PolygonMesh box_polygons(const Eigen::Vector3d& size) {
  PolygonMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        size.cwiseProduct(Eigen::Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1) - Eigen::Vector3d::Constant(0.5)));
  mesh.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return mesh;
}

PolygonMesh sphere_polygons(double radius, int divisions) {
  std::vector<Eigen::Vector2d> profile;
  add_cap(radius, 0.0, divisions, true, profile);
  profile.pop_back();  // the equator comes once
  add_cap(radius, 0.0, divisions, false, profile);
  return turned(profile, divisions);
}

PolygonMesh cylinder_polygons(double radius, double height, int divisions) {
  return turned({{radius, height / 2.0}, {radius, -height / 2.0}}, divisions);
}

PolygonMesh cone_polygons(double radius, double height, int divisions) {
  return turned({{0.0, height / 2.0}, {radius, -height / 2.0}}, divisions);
}

PolygonMesh capsule_polygons(double radius, double height, int divisions) {
  std::vector<Eigen::Vector2d> profile;
  add_cap(radius, height / 2.0, divisions, true, profile);
  add_cap(radius, -height / 2.0, divisions, false, profile);
  return turned(profile, divisions);
}

Result<PolygonMesh> extrusion_polygons(const Extrusion& extrusion) {
  const auto count_of = [](const auto& points) {
    return points.size() - (points.size() > 1 && points.front() == points.back() ? 1 : 0);
  };
  const std::size_t rings = count_of(extrusion.spine), corners = count_of(extrusion.section);
  if (rings < 2 || corners < 2) return error("an Extrusion needs two points of its spine and two of its section");
  const bool is_ring = rings < extrusion.spine.size(), is_tube = corners < extrusion.section.size();
  const SpineFrames frames(extrusion.spine, rings, is_ring);
  PolygonMesh mesh;
  mesh.crease_angle = extrusion.crease_angle;
  for (std::size_t i = 0; i < rings; ++i) {
    const Eigen::Vector2d scale = one_of(extrusion.scales, i, Eigen::Vector2d(1.0, 1.0));
    const Eigen::Matrix3d turn =
        frames.at(i) * one_of(extrusion.orientations, i, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
    for (std::size_t k = 0; k < corners; ++k) {
      const Eigen::Vector2d point = extrusion.section[k].cwiseProduct(scale);
      mesh.vertices.push_back(turn * Eigen::Vector3d(point.x(), 0.0, point.y()) + extrusion.spine[i]);
    }
  }
  const auto vertex = [corners](std::size_t ring, std::size_t k) { return static_cast<int>(ring * corners + k); };
  for (std::size_t i = 0; i + (is_ring ? 0 : 1) < rings; ++i) {
    for (std::size_t k = 0; k + (is_tube ? 0 : 1) < corners; ++k) {
      const std::size_t next = (i + 1) % rings, other = (k + 1) % corners;
      mesh.faces.push_back({vertex(i, k), vertex(next, other), vertex(next, k)});
      mesh.faces.push_back({vertex(i, k), vertex(i, other), vertex(next, other)});
    }
  }
  std::vector<int> begin, end;
  for (std::size_t k = 0; k < corners; ++k) {
    begin.push_back(vertex(0, corners - 1 - k));
    end.push_back(vertex(rings - 1, k));
  }
  if (extrusion.begin_cap && !is_ring && corners > 2) mesh.faces.push_back(begin);
  if (extrusion.end_cap && !is_ring && corners > 2) mesh.faces.push_back(end);
  return mesh;
}

Result<PolygonMesh> elevation_polygons(const ElevationGrid& grid) {
  const auto nx = static_cast<std::size_t>(std::max(grid.x_count, 0));
  const auto nz = static_cast<std::size_t>(std::max(grid.z_count, 0));
  if (nx < 2 || nz < 2 || nx * nz != grid.heights.size())
    return error(fmt::format("an ElevationGrid of {} x {} has {} heights", nx, nz, grid.heights.size()));
  PolygonMesh mesh;
  mesh.crease_angle = grid.crease_angle;
  for (std::size_t z = 0; z < nz; ++z)
    for (std::size_t x = 0; x < nx; ++x)
      mesh.vertices.emplace_back(static_cast<double>(x) * grid.x_spacing, grid.heights[z * nx + x],
                                 static_cast<double>(z) * grid.z_spacing);
  const auto vertex = [nx](std::size_t x, std::size_t z) { return static_cast<int>(z * nx + x); };
  for (std::size_t z = 0; z + 1 < nz; ++z) {
    for (std::size_t x = 0; x + 1 < nx; ++x) {
      mesh.faces.push_back({vertex(x, z), vertex(x, z + 1), vertex(x + 1, z + 1)});
      mesh.faces.push_back({vertex(x, z), vertex(x + 1, z + 1), vertex(x + 1, z)});
    }
  }
  return mesh;
}

}  // namespace rehearse
