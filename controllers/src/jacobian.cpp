#include <cnoid/Jacobian>

#include <cstddef>
#include <stdexcept>

#include "composite_inertia.h"

namespace cnoid {

namespace {

/// Momentum and angular momentum about the root link's origin, 6 x joints. With a base link the root moves so that the
/// base link doesn't.
MatrixXd jointMomenta(const Body& body, const Link* base, const CompositeInertias& composites) {
  if (base && base->body() != &body) throw std::invalid_argument("link " + base->name() + " belongs to another body");
  const Vector3 about = body.rootLink()->p();
  MatrixXd momenta = MatrixXd::Zero(6, body.numJoints());
  for (int id = 0; id < body.numJoints(); ++id) {
    const Link& joint = *body.joint(id);
    if (!joint.isValid()) continue;
    const CompositeInertia& below = composites[static_cast<std::size_t>(joint.index())];
    const Vector6 motion = jointMotion(joint, about);
    // Above a joint that carries the base link the rest of the body moves, in the opposite direction.
    const bool isBelowBase = base && base->isOwnerOf(&joint);
    momenta.col(id) = isBelowBase ? (composites[0] - below).momentum(-motion) : below.momentum(motion);
  }
  return momenta;
}

}  // namespace

void calcCMJacobian(Body* body, Link* base, MatrixXd& J) {
  const CompositeInertias composites = compositeInertias(*body);
  const CompositeInertia& whole = composites[0];
  const int n = body->numJoints();
  J.setZero(3, base ? n : n + 6);
  J.leftCols(n) = jointMomenta(*body, base, composites).topRows<3>() / whole.mass;
  if (base) return;
  for (int i = 0; i < 6; ++i) J.col(n + i) = whole.momentum(Vector6::Unit(i)).head<3>() / whole.mass;
}

void calcAngularMomentumJacobian(Body* body, Link* base, MatrixXd& H) {
  const CompositeInertias composites = compositeInertias(*body);
  const CompositeInertia& whole = composites[0];
  const int n = body->numJoints();
  MatrixXd momenta(6, base ? n : n + 6);
  momenta.leftCols(n) = jointMomenta(*body, base, composites);
  if (!base) {
    for (int i = 0; i < 6; ++i) momenta.col(n + i) = whole.momentum(Vector6::Unit(i));
  }
  const Vector3 from_point_to_root = base ? Vector3(body->rootLink()->p()) : Vector3(-whole.firstMoment / whole.mass);
  H.resize(3, momenta.cols());
  for (Eigen::Index i = 0; i < momenta.cols(); ++i) {
    H.col(i) = momenta.col(i).tail<3>() + from_point_to_root.cross(Vector3(momenta.col(i).head<3>()));
  }
}

Vector6 jacobianColumn(const JointPath& path, int joint, const Link* targetLink, const Vector3& point) {
  const Link& link = *path.joint(joint);
  const bool isBelow = targetLink->isOwnerOf(&link);
  const Vector6 motion = jointMotion(link, point);
  if (path.isJointDownward(joint)) return isBelow ? motion : Vector6(Vector6::Zero());
  return isBelow ? Vector6(Vector6::Zero()) : Vector6(-motion);
}

}  // namespace cnoid
