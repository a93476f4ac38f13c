// ODE's geoms for the shapes of models. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>

#include <memory>
#include <vector>

#include "polytope.h"

namespace rehearse {

struct MadeGeom {
  dGeomID geom = nullptr;
  std::shared_ptr<const Polytope> polytope;          // of boxes and hulls, in the geom's frame
  std::shared_ptr<const void> kept;                  // what ODE has pointers to: has to live as long as the geom
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // of the geom's frame in the shape's, whose axes it has [m]
};

/// The geoms of a shape. A mesh gives one a hull, each about its own middle (ODE's convex geoms hold their origin), or,
/// as a `trimesh`, one of all its triangles; what it is made of must be there.
std::vector<MadeGeom> make_geoms(const Geometry& geometry, bool trimesh);

}  // namespace rehearse
