#include "shape_contacts.h"

#include <algorithm>

#include "ground_peaks.h"
#include "hull_contacts.h"
#include "ode_math.h"

namespace rehearse {
namespace {

using Eigen::Isometry3d;

bool is_hull(const BodyShape& shape) { return dGeomGetClass(shape.geom) == dConvexClass; }

Isometry3d pose_of(dGeomID geom) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation(dGeomGetRotation(geom));
  pose.translation() = vector(dGeomGetPosition(geom));
  return pose;
}

/// The contact points of a shape with a hull, in the hull's frame; `pose`: of the shape in that frame.
std::vector<TouchPoint> touch(const Polytope& hull, const BodyShape& other, const Isometry3d& pose) {
  if (other.polytope) return touch_hull(hull, PlacedPolytope(*other.polytope, pose));
  dReal radius, length;
  switch (dGeomGetClass(other.geom)) {
    case dSphereClass: return touch_sphere(hull, pose.translation(), dGeomSphereGetRadius(other.geom));
    case dCapsuleClass:
      dGeomCapsuleGetParams(other.geom, &radius, &length);
      return touch_capsule(hull, {pose.translation(), pose.linear(), radius, 0.5 * length});
    case dCylinderClass:
      dGeomCylinderGetParams(other.geom, &radius, &length);
      return touch_cylinder(hull, {pose.translation(), pose.linear(), radius, 0.5 * length});
    default: REHEARSE_ASSERT(false, "a geom of a class that models don't have");
  }
}

}  // namespace

int collide_shapes(const BodyShape& a, const BodyShape& b, std::vector<dContactGeom>& found) {
  const auto is_trimesh = [](const BodyShape& shape) { return dGeomGetClass(shape.geom) == dTriMeshClass; };
  const bool on_ground = a.heightmap || b.heightmap;
  if (on_ground || is_trimesh(a) || is_trimesh(b) || (!is_hull(a) && !is_hull(b))) {
    const int count = dCollide(a.geom, b.geom, static_cast<int>(found.size()), found.data(), sizeof(dContactGeom));
    if (!on_ground) return count;
    const std::span<dContactGeom> room = std::span(found).subspan(static_cast<std::size_t>(count));
    return count + (a.heightmap ? touch_peaks(a, b, true, room) : touch_peaks(b, a, false, room));
  }
  const bool first_is_hull = is_hull(a);
  const BodyShape& hull = first_is_hull ? a : b;
  const BodyShape& other = first_is_hull ? b : a;
  const Isometry3d frame = pose_of(hull.geom);
  const std::vector<TouchPoint> touches = touch(*hull.polytope, other, frame.inverse() * pose_of(other.geom));
  const std::size_t count = std::min(touches.size(), found.size());
  for (std::size_t i = 0; i < count; ++i) {
    dContactGeom& contact = found[i] = {};
    const Eigen::Vector3d position = frame * touches[i].position;
    // ODE's normal points into the first shape
    const Eigen::Vector3d normal = frame.linear() * (first_is_hull ? -touches[i].normal : touches[i].normal);
    std::copy(position.data(), position.data() + 3, contact.pos);
    std::copy(normal.data(), normal.data() + 3, contact.normal);
    contact.depth = touches[i].depth;
    contact.g1 = a.geom;
    contact.g2 = b.geom;
  }
  return static_cast<int>(count);
}

}  // namespace rehearse
