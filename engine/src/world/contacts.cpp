#include "contacts.h"

#include <algorithm>

#include "ode_math.h"
#include "shape_contacts.h"

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

BodyBounds bounds_of(const SimulatedBody& body) {
  BodyBounds bounds;
  bounds.shapes.resize(body.shapes().size());
  for (std::size_t i = 0; i < bounds.shapes.size(); ++i) {
    dGeomGetAABB(body.shapes()[i].geom, bounds.shapes[i].box);
    for (int axis = 0; axis < 6; axis += 2) {
      bounds.all.box[axis] = std::min(bounds.all.box[axis], bounds.shapes[i].box[axis]);
      bounds.all.box[axis + 1] = std::max(bounds.all.box[axis + 1], bounds.shapes[i].box[axis + 1]);
    }
  }
  return bounds;
}

/// A shape and its body.
struct Side {
  const SimulatedBody& body;
  const BodyShape& shape;
  dBodyID ode = dGeomGetBody(shape.geom);

  /// True if forces move the shape.
  bool yields() const { return ode && !dBodyIsKinematic(ode); }
  bool has_belt() const { return shape.belt >= 0; }
};

/// Sets the friction of a contact with a belt: along the belt, towards the belt's speed. ODE's normal points into the
/// first shape; a surface runs with the speed of a wheel about its axis: axis x outward normal.
void run_belts(const Side& a, const Side& b, dContact& contact) {
  const Eigen::Vector3d normal = vector(contact.geom.normal);
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();  // velocity of a relative to b
  for (const Side* side : {&b, &a}) {
    if (!side->has_belt()) continue;
    const Belt belt = side->body.belt(side->shape.belt);
    const Eigen::Vector3d direction = belt.along(normal);
    if (direction.isZero(0.0)) continue;
    along = direction;
    // -(axis x outward) of a, whose outward normal is -normal, and axis x outward of b: the same direction
    wanted += belt.speed * along;
  }
  if (along.isZero(0.0)) return;
  contact.surface.mode &= ~dContactMu2;  // a belt's direction replaces the surface's friction direction
  contact.surface.mode |= dContactFDir1 | dContactMotion1 | dContactMotion2;
  std::copy(along.data(), along.data() + 3, contact.fdir1);
  // if the first body is null, ODE swaps the bodies and reverses the normal, and with it the second direction, but not
  // fdir1
  contact.surface.motion1 = a.ode ? wanted.dot(along) : -wanted.dot(along);
  contact.surface.motion2 = wanted.dot(normal.cross(along));
}

TouchedSurface surface_of(const Side& side) {
  const Surface& surface = side.body.description().model->links[side.shape.link].surface;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  if (surface.friction_direction)
    direction = side.body.link_point(side.shape.link, *surface.friction_direction) -
                side.body.link_point(side.shape.link, Eigen::Vector3d::Zero());
  const std::vector<std::string>& materials = side.body.description().materials;
  return {surface, direction, materials.empty() ? std::string_view() : materials[side.shape.link]};
}

/// Adds the contacts of two shapes; true if they touch. Two shapes that no force moves don't touch.
bool collide(dWorldID world, dJointGroupID group, const Side& a, const Side& b, const ContactLaw& law,
             std::vector<dContactGeom>& found, Touches& touches) {
  if (!a.yields() && !b.yields()) return false;
  const int count = collide_shapes(a.shape, b.shape, found);
  for (int i = 0; i < count; ++i) {
    dContact contact{};
    contact.geom = found[i];
    law.apply(surface_of(a), surface_of(b), contact);
    if (a.has_belt() || b.has_belt()) run_belts(a, b, contact);
    const dJointID joint = dJointCreateContact(world, group, &contact);
    dJointAttach(joint, a.ode, b.ode);
    if (a.body.feels(a.shape.link) || b.body.feels(b.shape.link))
      touches.keep(joint, contact.geom, {a.body, a.shape}, {b.body, b.shape});
  }
  return count > 0;
}

}  // namespace

void add_contacts(dWorldID world, dJointGroupID group, const std::vector<std::unique_ptr<SimulatedBody>>& bodies,
                  const ContactLaw& law, int max_contacts, Touches& touches, std::vector<LinkPair>& pairs) {
  touches.clear();
  pairs.clear();
  std::vector<BodyBounds> bounds;
  bounds.reserve(bodies.size());
  for (const auto& body : bodies) bounds.push_back(bounds_of(*body));
  std::vector<dContactGeom> found(max_contacts);
  const auto meet = [&](std::size_t i, std::size_t shape, std::size_t j, std::size_t other) {
    const BodyShape &a = bodies[i]->shapes()[shape], &b = bodies[j]->shapes()[other];
    if (!collide(world, group, {*bodies[i], a}, {*bodies[j], b}, law, found, touches)) return;
    pairs.push_back(LinkPair::of(static_cast<int>(i), a.link, static_cast<int>(j), b.link));
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const auto& [a, b] : bodies[i]->own_pairs())
      if (overlap(bounds[i].shapes[a], bounds[i].shapes[b])) meet(i, a, i, b);
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!overlap(bounds[i].all, bounds[j].all)) continue;
      for (std::size_t a = 0; a < bounds[i].shapes.size(); ++a) {
        if (!overlap(bounds[i].shapes[a], bounds[j].all)) continue;
        for (std::size_t b = 0; b < bounds[j].shapes.size(); ++b)
          if (overlap(bounds[i].shapes[a], bounds[j].shapes[b])) meet(i, a, j, b);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace rehearse
