// The inertia of a link together with all links below it, and the motion that a joint gives to them.
//
// Everything is in world axes about one point, the origin of the root link.
#pragma once

#include <cnoid/Body>

#include <vector>

namespace cnoid {

struct CompositeInertia {
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW
  double mass = 0.0;
  Vector3 firstMoment = Vector3::Zero();  // mass times the centre's place
  Matrix3 inertia = Matrix3::Zero();

  CompositeInertia& operator+=(const CompositeInertia& other);
  CompositeInertia operator-(const CompositeInertia& other) const;
  /// Momentum, then angular momentum, of a motion: velocity at the point, then angular velocity.
  Vector6 momentum(const Vector6& motion) const;
};

using CompositeInertias = std::vector<CompositeInertia, Eigen::aligned_allocator<CompositeInertia>>;

/// By link index.
CompositeInertias compositeInertias(const Body& body);

/// The motion of the links below a joint that moves with velocity 1. Zero for other than revolute and prismatic joints.
Vector6 jointMotion(const Link& joint, const Vector3& about);

}  // namespace cnoid
