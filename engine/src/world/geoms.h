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
  std::shared_ptr<const Polytope> polytope;                // of boxes and hulls, in the geom's frame
  std::shared_ptr<const void> kept;                        // data that ODE points to: must live as long as the geom
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the geom's frame in the shape's
  std::shared_ptr<const Heightmap> heightmap = nullptr;    // of which the geom is made; null: none
};

/// Makes the geoms of a shape. A mesh gives one geom per hull, or one of its heightmap, or one of all its triangles.
/// The frame of a hull's geom is at the hull's middle, because the origin of an ODE convex geom must be inside it; that
/// of a heightmap has its y axis upwards. The mesh must be loaded.
std::vector<MadeGeom> make_geoms(const Geometry& geometry);

}  // namespace rehearse
