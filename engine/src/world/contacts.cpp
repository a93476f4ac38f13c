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

/// The bounds of each shape, and of all shapes of each body.
class AllBounds {
 public:
  explicit AllBounds(const std::vector<std::unique_ptr<SimulatedBody>>& bodies) {
    bodies_.reserve(bodies.size());
    for (const auto& body : bodies) add(*body);
  }
  const Bounds& of(std::size_t body) const { return bodies_[body].all; }
  const Bounds& of(std::size_t body, std::size_t shape) const { return shapes_[bodies_[body].first + shape]; }

 private:
  struct BodyBounds {
    std::size_t first;  // index of the body's first shape
    Bounds all{{dInfinity, -dInfinity, dInfinity, -dInfinity, dInfinity, -dInfinity}};
  };

  void add(const SimulatedBody& body) {
    BodyBounds& bounds = bodies_.emplace_back(BodyBounds{shapes_.size()});
    for (const BodyShape& shape : body.shapes()) {
      dReal* box = shapes_.emplace_back().box;
      dGeomGetAABB(shape.geom, box);
      for (int axis = 0; axis < 6; axis += 2) {
        bounds.all.box[axis] = std::min(bounds.all.box[axis], box[axis]);
        bounds.all.box[axis + 1] = std::max(bounds.all.box[axis + 1], box[axis + 1]);
      }
    }
  }

  std::vector<Bounds> shapes_;
  std::vector<BodyBounds> bodies_;
};

using Contact = Touches::Contact;

/// The most friction of a belt across its direction: Choreonoid's ODE simulator item sets it.
constexpr double friction_across_belt = 0.5;

/// Sets the friction of a contact with a belt: along the belt, towards the belt's speed. ODE's normal points into the
/// first shape; a surface runs with the speed of a wheel about its axis: axis x outward normal.
void run_belts(const Contact& touch, dContact& contact) {
  const Eigen::Vector3d normal = vector(contact.geom.normal);
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();  // velocity of a relative to b
  for (const Contact::Side* side : {&touch.b, &touch.a}) {
    if (!side->has_belt()) continue;
    const Belt belt = side->body->belt(side->shape->belt);
    const Eigen::Vector3d direction = belt.along(normal);
    if (direction.isZero(0.0)) continue;
    along = direction;
    // -(axis x outward) of a, whose outward normal is -normal, and axis x outward of b: the same direction
    wanted += belt.speed * along;
  }
  if (along.isZero(0.0)) return;
  contact.surface.mode |= dContactFDir1 | dContactMu2 | dContactMotion1 | dContactMotion2;
  // replaces that of the surface's friction direction
  contact.surface.mu2 = std::min(friction_across_belt, contact.surface.mu);
  std::copy(along.data(), along.data() + 3, contact.fdir1);
  // if the first body is null, ODE swaps the bodies and reverses the normal, and with it the second direction, but not
  // fdir1
  contact.surface.motion1 = touch.a.ode ? wanted.dot(along) : -wanted.dot(along);
  contact.surface.motion2 = wanted.dot(normal.cross(along));
}

TouchedSurface surface_of(const Contact::Side& side) {
  const int link = side.shape->link;
  const Surface& surface = side.body->description().model->links[link].surface;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  if (surface.friction_direction)
    direction =
        side.body->link_point(link, *surface.friction_direction) - side.body->link_point(link, Eigen::Vector3d::Zero());
  const std::vector<std::string>& materials = side.body->description().materials;
  return {surface, direction, materials.empty() ? std::string_view() : materials[link]};
}

/// The mass on which friction between two bodies acts [kg].
double mass_between(const Contact& contact) {
  double inverse = 0.0;
  for (const Contact::Side* side : {&contact.a, &contact.b})
    if (side->yields()) inverse += 1.0 / side->body->mass();
  return 1.0 / inverse;
}

/// Finds the contacts of two shapes. Two shapes that no force moves don't touch.
void collide(const LinkPair& pair, const Touches::Party& a, const Touches::Party& b, std::vector<dContactGeom>& found,
             Touches& touches, Friction& friction) {
  const auto yields = [](const Touches::Party& party) {
    const dBodyID body = dGeomGetBody(party.shape.geom);
    return body && !dBodyIsKinematic(body);
  };
  if (!yields(a) && !yields(b)) return;
  const int count = collide_shapes(a.shape, b.shape, found);
  if (count == 0) return;
  FrictionPatch& patch = *friction.patch_of(pair);
  for (int i = 0; i < count; ++i) {
    Contact& contact = touches.add(found[i], a, b);
    if (i == 0) {
      patch.spin = contact.spin();
      patch.mass = mass_between(contact);
    }
    contact.patch = &patch;
    Friction::add(vector(found[i].pos), patch);
  }
}

/// `contact`: room for ODE's description of the contact.
void add_contact(dWorldID world, dJointGroupID group, const ContactLaw& law, const ContactTerms& terms,
                 const Friction& friction, DirectStep* direct, Contact& touch, dContact& contact) {
  contact.geom = touch.geom;
  terms.apply(contact);
  if ((touch.a.has_belt() || touch.b.has_belt()) && law.drives(touch.geom.depth)) run_belts(touch, contact);
  if (!(contact.surface.mode & dContactFDir1)) friction.direct(touch.point(), touch.velocity(), contact);
  if (direct && direct->solves(touch)) return direct->add(touch, contact, Friction::last_force(touch.point()));
  const dJointID joint = dJointCreateContact(world, group, &contact);
  dJointAttach(joint, touch.a.ode, touch.b.ode);
  dJointSetFeedback(joint, &touch.feedback);
}

}  // namespace

void find_contacts(const std::vector<std::unique_ptr<SimulatedBody>>& bodies, const Connections& connections,
                   std::vector<dContactGeom>& found, Touches& touches, Friction& friction,
                   std::vector<LinkPair>& pairs) {
  touches.clear();
  friction.begin();
  pairs.clear();
  const AllBounds bounds(bodies);
  const auto meet = [&](std::size_t i, std::size_t shape, std::size_t j, std::size_t other) {
    const BodyShape &a = bodies[i]->shapes()[shape], &b = bodies[j]->shapes()[other];
    if (!connections.empty() && connections.connect(static_cast<int>(i), a.link, static_cast<int>(j), b.link)) return;
    const LinkPair pair = LinkPair::of(static_cast<int>(i), a.link, static_cast<int>(j), b.link);
    collide(pair, {*bodies[i], a}, {*bodies[j], b}, found, touches, friction);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i]->description().touches) continue;
    for (const auto& [a, b] : bodies[i]->own_pairs())
      if (overlap(bounds.of(i, a), bounds.of(i, b))) meet(i, a, i, b);
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!bodies[j]->description().touches || !overlap(bounds.of(i), bounds.of(j))) continue;
      for (std::size_t a = 0; a < bodies[i]->shapes().size(); ++a) {
        if (!overlap(bounds.of(i, a), bounds.of(j))) continue;
        for (std::size_t b = 0; b < bodies[j]->shapes().size(); ++b)
          if (overlap(bounds.of(i, a), bounds.of(j, b))) meet(i, a, j, b);
      }
    }
  }
  for (const auto& [pair, patch] : friction.patches())
    if (patch.points > 0) pairs.push_back(pair);
  for (const Contact& contact : touches.contacts()) Friction::add_spread(contact.point());
}

void add_contacts(dWorldID world, dJointGroupID group, const ContactLaw& law, const Friction& friction,
                  const Sleep& sleep, Touches& touches, DirectStep* direct) {
  ContactTerms terms;
  dContact room{};
  const Contact* last = nullptr;  // the contacts of two shapes follow each other
  for (Contact& contact : touches.contacts()) {
    if (sleep.is_asleep(contact)) {
      contact.set_force(Friction::last_force(contact.point()));
      continue;
    }
    if (!last || last->a.shape != contact.a.shape || last->b.shape != contact.b.shape)
      terms = law.between(surface_of(contact.a), surface_of(contact.b));
    last = &contact;
    add_contact(world, group, law, terms, friction, direct, contact, room);
  }
}

}  // namespace rehearse
