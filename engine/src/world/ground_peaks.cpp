#include "ground_peaks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ode_math.h"

namespace rehearse {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A point inside a shape.
struct Inside {
  double depth;     // below the nearest surface [m]
  Vector3d normal;  // of that surface, outwards, in the shape's frame
};

std::optional<Inside> inside(const Polytope& hull, const Vector3d& point) {
  Inside nearest{unlimited, Vector3d::Zero()};
  for (const Plane& plane : hull.planes()) {
    const double depth = -plane.distance(point);
    if (depth <= 0.0) return std::nullopt;
    if (depth < nearest.depth) nearest = {depth, plane.normal};
  }
  return nearest;
}

/// Inside a sphere about the nearest point of a line along z, from -half to half: a sphere or a capsule.
std::optional<Inside> inside_round(const Vector3d& point, double radius, double half) {
  const Vector3d from(point.x(), point.y(), point.z() - std::clamp(point.z(), -half, half));
  const double distance = from.norm();
  if (distance >= radius || distance == 0.0) return std::nullopt;
  return Inside{radius - distance, from / distance};
}

std::optional<Inside> inside_cylinder(const Vector3d& point, double radius, double half) {
  const double across = std::hypot(point.x(), point.y());
  const Inside side{radius - across, Vector3d(point.x(), point.y(), 0.0) / std::max(across, 1e-12)};
  const Inside end{half - std::abs(point.z()), std::copysign(1.0, point.z()) * Vector3d::UnitZ()};
  if (side.depth <= 0.0 || end.depth <= 0.0) return std::nullopt;
  return side.depth < end.depth ? side : end;
}

/// The depth and normal of a point, in the shape's frame; nullopt if it is outside.
std::optional<Inside> inside(const BodyShape& shape, const Vector3d& point) {
  if (shape.polytope) return inside(*shape.polytope, point);
  dReal radius, length;
  switch (dGeomGetClass(shape.geom)) {
    case dSphereClass: return inside_round(point, dGeomSphereGetRadius(shape.geom), 0.0);
    case dCapsuleClass:
      dGeomCapsuleGetParams(shape.geom, &radius, &length);
      return inside_round(point, radius, 0.5 * length);
    case dCylinderClass:
      dGeomCylinderGetParams(shape.geom, &radius, &length);
      return inside_cylinder(point, radius, 0.5 * length);
    default: return std::nullopt;
  }
}

/// True if the point is above the line between two opposite neighbours.
bool is_peak(const Heightmap& map, int column, int row) {
  constexpr double least_slope = 1e-3;  // between both sides of a peak
  const double height = map.point(column, row).z();
  for (const auto& [x, y] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, -1)}) {  // along the edges of triangles
    if (column - x < 0 || column + x >= map.columns || std::min(row - y, row + y) < 0 ||
        std::max(row - y, row + y) >= map.rows)
      continue;
    const double length = std::hypot(x * map.cell().x(), y * map.cell().y());
    if (2.0 * height - map.point(column - x, row - y).z() - map.point(column + x, row + y).z() > least_slope * length)
      return true;
  }
  return false;
}

/// The columns or rows, from the first to the one after the last, of points between two places along a side.
std::pair<int, int> between(double low, double high, double size, int points) {
  const double cell = size / (points - 1);
  return {std::max(0, static_cast<int>(std::ceil(std::clamp((low + 0.5 * size) / cell, 0.0, 1e6)))),
          std::min(points, static_cast<int>(std::floor(std::clamp((high + 0.5 * size) / cell, -1.0, 1e6))) + 1)};
}

}  // namespace

int touch_peaks(const BodyShape& ground, const BodyShape& other, bool ground_first, std::span<dContactGeom> room) {
  const Heightmap& map = *ground.heightmap;
  Matrix3d upright;  // from the heightmap's frame to that of ODE's field, which has its y axis upwards
  upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Matrix3d axes = rotation(dGeomGetRotation(ground.geom)) * upright;
  const Vector3d place = vector(dGeomGetPosition(ground.geom));
  dReal box[6];  // min x, max x, min y, max y, min z, max z
  dGeomGetAABB(other.geom, box);
  Eigen::AlignedBox3d reach;
  for (int corner = 0; corner < 8; ++corner)
    reach.extend(axes.transpose() *
                 (Vector3d(box[corner & 1], box[2 + (corner >> 1 & 1)], box[4 + (corner >> 2 & 1)]) - place));
  const Matrix3d other_axes = rotation(dGeomGetRotation(other.geom));
  const Vector3d other_place = vector(dGeomGetPosition(other.geom));
  const auto [first_column, end_column] = between(reach.min().x(), reach.max().x(), map.size.x(), map.columns);
  const auto [first_row, end_row] = between(-reach.max().y(), -reach.min().y(), map.size.y(), map.rows);
  std::size_t count = 0;
  for (int row = first_row; row < end_row; ++row) {
    for (int column = first_column; column < end_column && count < room.size(); ++column) {
      const Vector3d peak = map.point(column, row);
      if (peak.z() < reach.min().z() || peak.z() > reach.max().z() || !is_peak(map, column, row)) continue;
      const Vector3d point = place + axes * peak;
      const auto touch = inside(other, other_axes.transpose() * (point - other_place));
      if (!touch) continue;
      const Vector3d outwards = other_axes * touch->normal;
      if (outwards.dot(axes.col(2)) >= 0.0) continue;  // the ground is below
      // ODE's normal points into the first shape
      const Vector3d normal = ground_first ? outwards : Vector3d(-outwards);
      dContactGeom& contact = room[count++] = {};
      std::copy(point.data(), point.data() + 3, contact.pos);
      std::copy(normal.data(), normal.data() + 3, contact.normal);
      contact.depth = touch->depth;
      contact.g1 = ground_first ? ground.geom : other.geom;
      contact.g2 = ground_first ? other.geom : ground.geom;
    }
  }
  return static_cast<int>(count);
}

}  // namespace rehearse
