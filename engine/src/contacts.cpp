#include "contacts.h"

#include <algorithm>

namespace rehearse {
namespace {

struct Bounds {
  dReal box[6];  // min x, max x, min y, max y, min z, max z
};

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 6; axis += 2)
    if (a.box[axis] > b.box[axis + 1] || a.box[axis + 1] < b.box[axis]) return false;
  return true;
}

/// The bounds of each shape of a body, and of all of them.
struct BodyBounds {
  std::vector<Bounds> shapes;
  Bounds all{{dInfinity, -dInfinity, dInfinity, -dInfinity, dInfinity, -dInfinity}};
};

BodyBounds bounds_of(const OdeBody& body) {
  BodyBounds bounds;
  bounds.shapes.resize(body.geoms().size());
  for (std::size_t i = 0; i < bounds.shapes.size(); ++i) {
    dGeomGetAABB(body.geoms()[i], bounds.shapes[i].box);
    for (int axis = 0; axis < 6; axis += 2) {
      bounds.all.box[axis] = std::min(bounds.all.box[axis], bounds.shapes[i].box[axis]);
      bounds.all.box[axis + 1] = std::max(bounds.all.box[axis + 1], bounds.shapes[i].box[axis + 1]);
    }
  }
  return bounds;
}

void collide(dWorldID world, dJointGroupID group, dGeomID a, dGeomID b, const SolverSettings& settings,
             std::vector<dContactGeom>& found) {
  const dBodyID body_a = dGeomGetBody(a);
  const dBodyID body_b = dGeomGetBody(b);
  if (!body_a && !body_b) return;
  const int count = dCollide(a, b, settings.max_contacts, found.data(), sizeof(dContactGeom));
  for (int i = 0; i < count; ++i) {
    dContact contact{};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = settings.friction;
    contact.geom = found[i];
    dJointAttach(dJointCreateContact(world, group, &contact), body_a, body_b);
  }
}

}  // namespace

void add_contacts(dWorldID world, dJointGroupID group, const std::vector<std::unique_ptr<OdeBody>>& bodies,
                  const SolverSettings& settings) {
  std::vector<BodyBounds> bounds;
  bounds.reserve(bodies.size());
  for (const auto& body : bodies) bounds.push_back(bounds_of(*body));
  std::vector<dContactGeom> found(settings.max_contacts);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!overlap(bounds[i].all, bounds[j].all)) continue;
      for (std::size_t a = 0; a < bounds[i].shapes.size(); ++a) {
        if (!overlap(bounds[i].shapes[a], bounds[j].all)) continue;
        for (std::size_t b = 0; b < bounds[j].shapes.size(); ++b)
          if (overlap(bounds[i].shapes[a], bounds[j].shapes[b]))
            collide(world, group, bodies[i]->geoms()[a], bodies[j]->geoms()[b], settings, found);
      }
    }
  }
}

}  // namespace rehearse
