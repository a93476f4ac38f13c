#include "touches.h"

#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;

Touches::Side Touches::side_of(const Party& party, const Vector3d& point, const Vector3d& outward) {
  Side side{&party.body, &party.shape, dGeomGetBody(party.shape.geom), Vector3d::Zero(), Vector3d::Zero()};
  if (side.ode) side.arm = point - vector(dBodyGetPosition(side.ode));
  if (party.shape.belt >= 0) {
    const Belt belt = party.body.belt(party.shape.belt);
    side.belt = belt.speed * belt.along(outward);
  }
  return side;
}

Vector3d Touches::Side::velocity() const {
  if (!ode) return belt;
  return vector(dBodyGetLinearVel(ode)) + vector(dBodyGetAngularVel(ode)).cross(arm) + belt;
}

void Touches::keep(dJointID joint, const dContactGeom& geom, const Party& a, const Party& b) {
  const Vector3d point = vector(geom.pos), normal = vector(geom.normal);
  Kept& kept = kept_.emplace_back(Kept{geom, side_of(a, point, -normal), side_of(b, point, normal), {}});
  dJointSetFeedback(joint, &kept.feedback);
}

std::vector<Touch> Touches::of(const SimulatedBody& body) const {
  std::vector<Touch> touches;
  for (const Kept& kept : kept_) {
    // ODE reports the force on the joint's first body, which is b's if a has none
    const Vector3d reported = vector(kept.feedback.f1);
    const Vector3d on_a = kept.a.ode ? reported : Vector3d(-reported);
    const Vector3d velocity = kept.a.velocity() - kept.b.velocity();
    for (const auto& [side, sign] : {std::pair(&kept.a, 1.0), std::pair(&kept.b, -1.0)}) {
      if (side->body != &body || !body.feels(side->shape->link)) continue;
      touches.push_back(
          {side->shape->link,
           side->shape->collision,
           {vector(kept.geom.pos), sign * vector(kept.geom.normal), sign * on_a, sign * velocity, kept.geom.depth}});
    }
  }
  return touches;
}

}  // namespace rehearse
