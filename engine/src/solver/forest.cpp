#include "forest.h"

#include <Eigen/Geometry>
#include <array>

namespace rehearse {
namespace {

using Eigen::Vector3d;
using Line = Eigen::Matrix<double, 1, 6>;

/// X' f: a body's momentum as its parent gets it.
Vector6d shifted(const Vector3d& arm, Vector6d f) {
  f.tail<3>() += arm.cross(Vector3d(f.head<3>()));
  return f;
}

/// x' m, line by line.
template <class Matrix>
Line times(const Vector6d& x, const Matrix& m) {
  Line sum = x[0] * m.row(0);
  for (int i = 1; i < 6; ++i) sum += x[i] * m.row(i);
  return sum;
}

/// X' m.
template <class Matrix>
void shift_rows(const Vector3d& r, Matrix& m) {
  m.row(3) += r[1] * m.row(2) - r[2] * m.row(1);
  m.row(4) += r[2] * m.row(0) - r[0] * m.row(2);
  m.row(5) += r[0] * m.row(1) - r[1] * m.row(0);
}

/// m X.
template <class Matrix>
void shift_columns(const Vector3d& r, Matrix& m) {
  m.col(3) += r[1] * m.col(2) - r[2] * m.col(1);
  m.col(4) += r[2] * m.col(0) - r[0] * m.col(2);
  m.col(5) += r[0] * m.col(1) - r[1] * m.col(0);
}

}  // namespace

void Forest::arrange() {
  nodes_.resize(bodies_.size());
  int count = 0;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    nodes_[body].begin = count;
    nodes_[body].end = count += bodies_[body].joint.coordinates();
  }
  coordinates_.resize(static_cast<std::size_t>(count));
  clear_columns();
}

/// The joint and the masses of a body, before anything is eliminated.
void Forest::load(int body) {
  const TreeBody& of = bodies_[body];
  Node& node = nodes_[body];
  node.inertia.setZero();
  for (int i = 0; i < 3; ++i) node.inertia(i, i) = of.mass;
  node.inertia.bottomRightCorner<3, 3>() = of.inertia;
  for (int at = node.begin; at < node.end; ++at) {
    Coordinate& coordinate = coordinates_[at];
    coordinate.axis = of.joint.axis(at - node.begin);
    coordinate.is_driven = of.drive.has_value();
    coordinate.softness = of.drive ? of.drive->softness : 0.0;
  }
}

/// Where a drive holds, softness 0 needs no case: the rate is then the target.
void Forest::eliminate(int body) {
  const TreeBody& of = bodies_[body];
  Node& node = nodes_[body];
  Matrix& m = node.inertia;
  for (int at = node.begin; at < node.end; ++at) {
    Coordinate& coordinate = coordinates_[at];
    const Line line = times(coordinate.axis, m);
    coordinate.reaction = line.transpose();
    coordinate.inertia = dot6(coordinate.axis, coordinate.reaction) + of.gain;
    coordinate.yield =
        1.0 / (coordinate.is_driven ? 1.0 + coordinate.softness * coordinate.inertia : coordinate.inertia);
    coordinate.mobility = coordinate.is_driven ? coordinate.softness * coordinate.yield : coordinate.yield;
    if (at + 1 == node.end && of.parent < 0) return;  // nothing needs the rest
    for (int i = 0; i < 6; ++i) m.row(i) -= (coordinate.reaction[i] * coordinate.mobility) * line;
  }
  if (of.parent < 0) return;
  node.of_bias = times(of.joint.bias, m).transpose();
  shift_rows(of.joint.arm, m);
  shift_columns(of.joint.arm, m);
}

void Forest::factor(int first, int last) {
  for (int body = first; body < last; ++body) nodes_[body].is_stale = true;
  refactor(first, last);
}

void Forest::change_drive(int body) {
  for (int at = body; at >= 0 && !nodes_[at].is_stale; at = bodies_[at].parent) nodes_[at].is_stale = true;
}

void Forest::refactor(int first, int last) {
  for (int body = first; body < last; ++body)
    if (nodes_[body].is_stale) load(body);
  for (int body = last; body-- > first;) {
    Node& node = nodes_[body];
    if (node.is_stale) eliminate(body);
    node.is_stale = false;
    const int parent = bodies_[body].parent;
    if (parent >= 0 && nodes_[parent].is_stale) nodes_[parent].inertia += node.inertia;
  }
}

void Forest::solve(int first, int last) {
  for (int body = first; body < last; ++body) {
    const TreeBody& of = bodies_[body];
    Node& node = nodes_[body];
    node.g = of.momentum;
    node.pushed.setZero();
    for (int at = node.begin; at < node.end; ++at) {
      coordinates_[at].offset = of.offset + of.push;
      if (of.drive) coordinates_[at].target = of.drive->target;
    }
  }
  for (int body = last; body-- > first;) {
    Node& node = nodes_[body];
    for (int at = node.begin; at < node.end; ++at) {
      Coordinate& coordinate = coordinates_[at];
      coordinate.u = dot6(coordinate.axis, node.g) + coordinate.offset;
      node.g -= coordinate.reaction * coordinate.rate_alone();
    }
    const int parent = bodies_[body].parent;
    if (parent >= 0) nodes_[parent].g += shifted(bodies_[body].joint.arm, node.g - node.of_bias);
  }
  descend(first, last);
}

template <class Done>
void Forest::climb(int body, Vector6d momentum, double on_joint, Done&& done) {
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    const Node& node = nodes_[at];
    for (int i = node.begin; i < node.end; ++i) {
      Coordinate& coordinate = coordinates_[i];
      const double u = dot6(coordinate.axis, momentum) + on_joint;
      done(i, coordinate, u);
      momentum -= coordinate.reaction * (u * coordinate.mobility);
    }
    on_joint = 0.0;
    momentum = shifted(bodies_[at].joint.arm, momentum);
  }
}

void Forest::push(int body, const Vector6d& momentum) {
  nodes_[body].pushed += momentum;
  climb(body, momentum, 0.0, [](int, Coordinate& coordinate, double u) { coordinate.u += u; });
}

void Forest::push_joint(int body, double impulse) {
  climb(body, Vector6d::Zero(), impulse, [](int, Coordinate& coordinate, double u) { coordinate.u += u; });
}

/// The impulse of a drive is never (target - rate) / softness: for a stiff drive that loses most digits.
void Forest::descend(int first, int last) {
  for (int body = first; body < last; ++body) {
    const TreeBody& of = bodies_[body];
    Node& node = nodes_[body];
    node.velocity = of.joint.bias;
    if (of.parent >= 0) {
      const Vector6d& of_parent = nodes_[of.parent].velocity;
      node.velocity += of_parent;
      node.velocity.head<3>() += Vector3d(of_parent.tail<3>()).cross(of.joint.arm);
    }
    for (int at = node.end; at-- > node.begin;) {
      Coordinate& coordinate = coordinates_[at];
      const double resisted = dot6(coordinate.reaction, node.velocity);
      if (coordinate.is_driven) {
        coordinate.impulse = (coordinate.inertia * coordinate.target - coordinate.u + resisted) * coordinate.yield;
        coordinate.rate = coordinate.target - coordinate.softness * coordinate.impulse;
      } else {
        coordinate.impulse = 0.0;
        coordinate.rate = (coordinate.u - resisted) * coordinate.mobility;
      }
      node.velocity += coordinate.axis * coordinate.rate;
    }
  }
}

void Forest::find_wrenches(int first, int last) {
  for (int body = first; body < last; ++body) {
    const TreeBody& of = bodies_[body];
    Node& node = nodes_[body];
    node.wrench = spatial(of.mass * node.velocity.head<3>(), of.inertia * node.velocity.tail<3>());
    node.wrench -= of.momentum + node.pushed;
  }
  for (int body = last; body-- > first;) {
    const int parent = bodies_[body].parent;
    if (parent >= 0) nodes_[parent].wrench += shifted(bodies_[body].joint.arm, nodes_[body].wrench);
  }
}

int Forest::add_body_columns(int body) {
  const std::size_t size = coordinates_.size(), begin = bodies_with_columns_++ * size;
  if (body_halves_.size() < begin + size) body_halves_.resize(begin + size);
  groups_.push_back({body, true, begin});
  Matrix momentum = Matrix::Identity();
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    const Node& node = nodes_[at];
    for (int i = node.begin; i < node.end; ++i) {
      const Coordinate& coordinate = coordinates_[i];
      const Line half = times(coordinate.axis, momentum), share = half * coordinate.mobility;
      body_halves_[begin + static_cast<std::size_t>(i)] = half;
      for (int r = 0; r < 6; ++r) momentum.row(r) -= coordinate.reaction[r] * share;
    }
    shift_rows(bodies_[at].joint.arm, momentum);
  }
  return static_cast<int>(groups_.size()) - 1;
}

int Forest::add_joint_column(int body) {
  const std::size_t size = coordinates_.size(), begin = joints_with_columns_++ * size;
  if (joint_halves_.size() < begin + size) joint_halves_.resize(begin + size);
  groups_.push_back({body, false, begin});
  climb(body, Vector6d::Zero(), 1.0,
        [&](int i, Coordinate&, double u) { joint_halves_[begin + static_cast<std::size_t>(i)] = u; });
  return static_cast<int>(groups_.size()) - 1;
}

/// From `body` to the root: the sum of u u' mobility.
template <int Width, int Other>
void Forest::multiply(int body, const Group& first, const Group& second, double* place, std::size_t stride) const {
  using Row = Eigen::Matrix<double, 1, Other>;
  const auto half = [&](const Group& of, int i) {
    const std::size_t index = of.begin + static_cast<std::size_t>(i);
    return of.is_body ? body_halves_[index].data() : &joint_halves_[index];
  };
  std::array<Row, Width> sums;
  for (Row& sum : sums) sum.setZero();
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    for (int i = nodes_[at].begin; i < nodes_[at].end; ++i) {
      const double* a = half(first, i);
      const Row line = Eigen::Map<const Row>(half(second, i)) * coordinates_[i].mobility;
      for (int r = 0; r < Width; ++r) sums[r] += a[r] * line;
    }
  }
  for (int r = 0; r < Width; ++r)
    for (int c = 0; c < Other; ++c) place[r * stride + c] = sums[r][c];
}

void Forest::multiply(int group, int other, double* place, std::size_t stride) const {
  const Group &first = groups_[group], &second = groups_[other];
  int a = first.body, b = second.body;
  while (a != b && a >= 0 && b >= 0) {  // to the first body that both paths contain; parents have smaller indices
    int& lower = a > b ? a : b;
    lower = bodies_[lower].parent;
  }
  const int common = a == b ? a : -1;
  const auto with = second.is_body  ? first.is_body ? &Forest::multiply<6, 6> : &Forest::multiply<1, 6>
                     : first.is_body ? &Forest::multiply<6, 1>
                                    : &Forest::multiply<1, 1>;
  (this->*with)(common, first, second, place, stride);
}

}  // namespace rehearse
