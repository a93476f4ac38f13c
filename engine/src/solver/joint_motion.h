// JointMotion: how a joint lets a rigid body move in a step. Private to the engine.
#pragma once

#include <rehearse/diagnostic.h>

#include <Eigen/Core>
#include <array>

#include "rows.h"

namespace rehearse {

/// The velocity of a body at the end of a step, from that of its parent and the rates q of the joint's coordinates:
///     v = X v_parent + S q + b,    X = [1 -[r]x; 0 1]
/// Without a parent, or with the world as the parent, v_parent is 0.
class JointMotion {
 public:
  static constexpr int most_coordinates = 6;

  /// No coordinate: the body moves as its parent, by b.
  JointMotion() = default;
  /// Of a body that no joint guides.
  static JointMotion free() {
    JointMotion motion;
    for (int i = 0; i < most_coordinates; ++i) motion.add(Vector6d::Unit(i));
    return motion;
  }

  Eigen::Vector3d arm = Eigen::Vector3d::Zero();  // r: from the parent's centre of mass to the body's [m]
  Vector6d bias = Vector6d::Zero();               // b: the correction of the joint's error, or a given velocity

  void add(const Vector6d& axis) {
    REHEARSE_ASSERT(coordinates_ < most_coordinates, "a body has six motions");
    axes_[coordinates_++] = axis;
  }
  int coordinates() const { return coordinates_; }
  const Vector6d& axis(int coordinate) const { return axes_[coordinate]; }  // a column of S

 private:
  std::array<Vector6d, most_coordinates> axes_;
  int coordinates_ = 0;
};

}  // namespace rehearse
