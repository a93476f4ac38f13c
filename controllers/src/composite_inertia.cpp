#include "composite_inertia.h"

#include <cnoid/EigenUtil>
#include <cstddef>

namespace cnoid {

CompositeInertia& CompositeInertia::operator+=(const CompositeInertia& other) {
  mass += other.mass;
  firstMoment += other.firstMoment;
  inertia += other.inertia;
  return *this;
}

CompositeInertia CompositeInertia::operator-(const CompositeInertia& other) const {
  CompositeInertia rest = *this;
  rest.mass -= other.mass;
  rest.firstMoment -= other.firstMoment;
  rest.inertia -= other.inertia;
  return rest;
}

Vector6 CompositeInertia::momentum(const Vector6& motion) const {
  const Vector3 v = motion.head<3>();
  const Vector3 w = motion.tail<3>();
  Vector6 result;
  result << mass * v + w.cross(firstMoment), firstMoment.cross(v) + inertia * w;
  return result;
}

CompositeInertias compositeInertias(const Body& body) {
  CompositeInertias all(body.links().size());
  for (int i = body.numLinks() - 1; i >= 0; --i) {  // a parent always comes before its children
    const Link& link = *body.link(i);
    const Matrix3 arm = hat(link.T() * link.c() - body.rootLink()->p());
    CompositeInertia own;
    own.mass = link.m();
    own.firstMoment = link.m() * (link.T() * link.c() - body.rootLink()->p());
    own.inertia = link.R() * link.I() * link.R().transpose() + link.m() * arm * arm.transpose();
    CompositeInertia& composite = all[static_cast<std::size_t>(i)];
    composite += own;
    if (link.parent()) all[static_cast<std::size_t>(link.parent()->index())] += composite;
  }
  return all;
}

Vector6 jointMotion(const Link& joint, const Vector3& about) {
  Vector6 motion = Vector6::Zero();
  const Vector3 axis = joint.R() * joint.a();
  if (joint.isRevoluteJoint()) motion << (joint.p() - about).cross(axis), axis;
  if (joint.isPrismaticJoint()) motion.head<3>() = axis;
  return motion;
}

}  // namespace cnoid
