// Rows: equations of constraints between the velocities of rigid bodies. Private to the engine.
//
// Units: a row of a linear velocity is in m/s and its impulse in N·s; a row of an angular velocity is in rad/s and its
// impulse in N·m·s. Vectors are in world axes.
#pragma once

#include <rehearse/diagnostic.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>

namespace rehearse {

/// The linear part, then the angular part about the body's centre of mass.
using Vector6d = Eigen::Matrix<double, 6, 1>;

inline Vector6d spatial(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  Vector6d v;
  v << linear, angular;
  return v;
}

/// The scalar product, summed in order: its bits don't depend on the vector instructions of a processor.
template <class A, class B>
double dot6(const A& a, const B& b) {
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

/// An equation of the velocities v1 and v2 of two bodies at the end of a step, and of the constraint's impulse x:
///     first · v1 + second · v2 + softness x = target
/// The impulse changes the momentum of the bodies by first x and second x.
struct Row {
  Vector6d first = Vector6d::Zero();
  Vector6d second = Vector6d::Zero();
  double target = 0.0;
  double softness = 0.0;  // ODE's constraint force mixing divided by the time step
};

/// A list of rows without memory of its own on the heap.
template <std::size_t Capacity>
class RowList {
 public:
  Row& add() {
    REHEARSE_ASSERT(count_ < Capacity, "a joint has a bounded number of rows");
    rows_[count_] = {};
    return rows_[count_++];
  }
  std::size_t size() const { return count_; }
  Row& operator[](std::size_t i) { return rows_[i]; }
  const Row& operator[](std::size_t i) const { return rows_[i]; }
  const Row* begin() const { return rows_.data(); }
  const Row* end() const { return rows_.data() + count_; }

 private:
  std::array<Row, Capacity> rows_;
  std::size_t count_ = 0;
};

}  // namespace rehearse
