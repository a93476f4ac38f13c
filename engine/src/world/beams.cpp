#include "beams.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ground_beam.h"
#include "ode_math.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

/// A shape that beams may hit, and a sphere around it, a little larger than needed, for a quick test.
struct Target {
  dGeomID geom;
  const Polytope* hull;     // null: not a hull
  const Heightmap* ground;  // null: not ground; without both, the shape is tested by ODE
  Vector3d center;          // relative to the sensor [m]
  double radius;            // [m]
};

/// All shapes in the order of the bodies, without those of the sensor's rigid group and those out of range.
std::vector<Target> targets_of(const std::vector<std::unique_ptr<SimulatedBody>>& bodies, int owner, int link,
                               const Vector3d& origin, double reach) {
  std::vector<Target> targets;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    for (const BodyShape& shape : bodies[body]->shapes()) {
      if (static_cast<int>(body) == owner && bodies[body]->move_together(shape.link, link)) continue;
      dReal box[6];  // min x, max x, min y, max y, min z, max z
      dGeomGetAABB(shape.geom, box);
      const Vector3d low(box[0], box[2], box[4]), high(box[1], box[3], box[5]);
      const Polytope* hull = dGeomGetClass(shape.geom) == dConvexClass ? shape.polytope.get() : nullptr;
      const Target target{shape.geom, hull, shape.heightmap.get(), 0.5 * (low + high) - origin,
                          0.5001 * (high - low).norm() + 1e-6};
      if (target.center.norm() - target.radius <= reach) targets.push_back(target);
    }
  }
  return targets;
}

/// False only if a beam from the sensor in this direction doesn't hit the shape.
bool may_meet(const Target& target, const Vector3d& direction) {
  const double along = target.center.dot(direction);
  if (along < -target.radius) return false;
  return (target.center - along * direction).squaredNorm() <= target.radius * target.radius;
}

/// True if the point [m, world] is inside the shape. A trimesh has no inside: a sensor in a room sees its walls.
bool holds(dGeomID geom, const Vector3d& point) {
  switch (dGeomGetClass(geom)) {
    case dSphereClass: return dGeomSpherePointDepth(geom, point.x(), point.y(), point.z()) > 0.0;
    case dBoxClass: return dGeomBoxPointDepth(geom, point.x(), point.y(), point.z()) > 0.0;
    case dCapsuleClass: return dGeomCapsulePointDepth(geom, point.x(), point.y(), point.z()) > 0.0;
    case dCylinderClass: {
      dReal radius, length;
      dGeomCylinderGetParams(geom, &radius, &length);
      dVector3 local;
      dGeomGetPosRelPoint(geom, point.x(), point.y(), point.z(), local);
      return std::hypot(local[0], local[1]) < radius && std::abs(local[2]) < 0.5 * length;
    }
    default: return false;
  }
}

/// An ODE ray; its destructor destroys it.
class Ray {
 public:
  explicit Ray(double length) : ray_(dCreateRay(nullptr, length)), length_(length) {
    dGeomRaySetClosestHit(ray_, 1);  // of the triangles of a mesh
  }
  ~Ray() { dGeomDestroy(ray_); }
  Ray(const Ray&) = delete;
  Ray& operator=(const Ray&) = delete;

  void aim(const Vector3d& from, const Vector3d& direction) {
    from_ = from;
    direction_ = direction;
    dGeomRaySet(ray_, from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z());
  }
  /// Distance from the ray's beginning to the shape [m]; +inf if the ray doesn't hit it.
  double distance_to(const Target& target) const {
    if (target.hull) return distance_to_hull(target);
    if (target.ground) return distance_to_ground(target);
    dContactGeom hit;
    return dCollide(ray_, target.geom, 1, &hit, sizeof hit) > 0 ? hit.depth : nothing;
  }

 private:
  /// The hit is where the part of the ray behind all planes begins (M. Cyrus and J. Beck, 1978); none if the ray begins
  /// inside.
  double distance_to_hull(const Target& target) const {
    const Eigen::Matrix3d axes = rotation(dGeomGetRotation(target.geom));
    const Vector3d from = axes.transpose() * (from_ - vector(dGeomGetPosition(target.geom)));
    const Vector3d direction = axes.transpose() * direction_;
    double enters = -nothing, leaves = length_;
    for (const Plane& plane : target.hull->planes()) {
      const double speed = plane.normal.dot(direction);
      const double height = plane.distance(from);
      if (speed == 0.0 && height > 0.0) return nothing;
      if (speed < 0.0) enters = std::max(enters, height / -speed);
      if (speed > 0.0) leaves = std::min(leaves, height / -speed);
    }
    return enters >= 0.0 && enters <= leaves ? enters : nothing;
  }

  /// ODE tests all cells below the beam's box; these are only the cells below the beam.
  double distance_to_ground(const Target& target) const {
    const Eigen::Matrix3d axes = rotation(dGeomGetRotation(target.geom));
    const auto upright = [&axes](const Vector3d& vector) {  // ODE's field has its y axis upwards
      const Vector3d in_field = axes.transpose() * vector;
      return Vector3d(in_field.x(), -in_field.z(), in_field.y());
    };
    return beam_to_ground(*target.ground, upright(from_ - vector(dGeomGetPosition(target.geom))), upright(direction_),
                          length_);
  }

  static constexpr double nothing = std::numeric_limits<double>::infinity();
  dGeomID ray_;
  double length_;  // [m]
  Vector3d from_ = Vector3d::Zero(), direction_ = Vector3d::UnitX();
};

}  // namespace

std::vector<float> measure_beams(const RangeSensor& sensor, const Eigen::Isometry3d& pose,
                                 const std::vector<std::unique_ptr<SimulatedBody>>& bodies, int owner, int link) {
  const Vector3d origin = pose.translation();
  const std::vector<Target> targets = targets_of(bodies, owner, link, origin, sensor.max_distance);
  Ray ray(sensor.max_distance - sensor.min_distance);
  std::vector<float> distances;
  distances.reserve(static_cast<std::size_t>(sensor.beams()));
  for (const Vector3d& beam : beam_directions(sensor)) {
    const Vector3d direction = pose.linear() * beam;
    const Vector3d from = origin + sensor.min_distance * direction;
    ray.aim(from, direction);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Target& target : targets) {
      if (!may_meet(target, direction)) continue;
      const double distance = sensor.min_distance + ray.distance_to(target);
      if (distance < nearest && !holds(target.geom, from)) nearest = distance;
    }
    distances.push_back(static_cast<float>(nearest));
  }
  return distances;
}

}  // namespace rehearse
