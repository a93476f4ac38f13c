#include "touches.h"

#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;

void Touches::Contact::Side::run_belt(const Vector3d& outward) {
  const Belt running = body->belt(shape->belt);
  belt = running.speed * running.along(outward);
}

Vector3d Touches::Contact::force() const {
  // ODE reports the force on the joint's first body, which is b's if a has none
  const Vector3d reported = vector(feedback.f1);
  return a.ode ? reported : Vector3d(-reported);
}

void Touches::Contact::set_force(const Vector3d& force) {
  for (int axis = 0; axis < 3; ++axis) feedback.f1[axis] = a.ode ? force[axis] : -force[axis];
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
