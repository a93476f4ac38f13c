#include "touches.h"

#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;

namespace {

Touches::Contact::Side side_of(const Touches::Party& party, const Vector3d& point, const Vector3d& outward) {
  Touches::Contact::Side side{&party.body, &party.shape, dGeomGetBody(party.shape.geom), Vector3d::Zero(),
                              Vector3d::Zero()};
  if (side.ode) side.arm = point - vector(dBodyGetPosition(side.ode));
  if (side.has_belt()) {
    const Belt belt = party.body.belt(party.shape.belt);
    side.belt = belt.speed * belt.along(outward);
  }
  return side;
}

}  // namespace

Touches::Contact::Contact(const dContactGeom& of, const Party& first, const Party& second)
    : geom(of),
      a(side_of(first, vector(of.pos), -vector(of.normal))),
      b(side_of(second, vector(of.pos), vector(of.normal))) {}

Vector3d Touches::Contact::Side::velocity() const {
  if (!ode) return belt;
  return vector(dBodyGetLinearVel(ode)) + angular_velocity().cross(arm) + belt;
}

Vector3d Touches::Contact::Side::angular_velocity() const {
  return ode ? vector(dBodyGetAngularVel(ode)) : Vector3d(Vector3d::Zero());
}

Vector3d Touches::Contact::force() const {
  // ODE reports the force on the joint's first body, which is b's if a has none
  const Vector3d reported = vector(feedback.f1);
  return a.ode ? reported : Vector3d(-reported);
}

std::vector<Touch> Touches::of(const SimulatedBody& body) const {
  std::vector<Touch> touches;
  for (const Contact& contact : contacts_) {
    for (const auto& [side, sign] : {std::pair(&contact.a, 1.0), std::pair(&contact.b, -1.0)}) {
      if (side->body != &body || !body.feels(side->shape->link)) continue;
      touches.push_back({side->shape->link,
                         side->shape->collision,
                         {vector(contact.geom.pos), sign * vector(contact.geom.normal), sign * contact.force(),
                          sign * contact.velocity(), contact.geom.depth}});
    }
  }
  return touches;
}

}  // namespace rehearse
