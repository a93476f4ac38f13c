#include "forest.h"

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace rehearse {
namespace {

/// Replaces the upper triangle of a symmetric matrix by its Cholesky factor R with R' R = a and with reciprocals on the
/// diagonal. Rows beyond `size` are left out, and columns beyond N. The lower triangle is undefined.
template <int N, class Matrix>
inline void factor_symmetric(Matrix& a, int size) {
  for (int j = 0; j < size; ++j) {
    const double reciprocal = 1.0 / std::sqrt(a(j, j));
    a.row(j).template head<N>() *= reciprocal;
    for (int i = j + 1; i < size; ++i) a.row(i).template head<N>() -= a(j, i) * a.row(j).template head<N>();
    a(j, j) = reciprocal;
  }
}

/// x = R'^-1 x
template <class Matrix, class Vector>
inline void solve_transposed(const Matrix& r, int size, Vector& x) {
  for (int i = 0; i < size; ++i) {
    double sum = x[i];
    for (int k = 0; k < i; ++k) sum -= r(k, i) * x[k];
    x[i] = sum * r(i, i);
  }
}

/// x = R^-1 x
template <class Matrix, class Vector>
inline void solve_upper(const Matrix& r, int size, Vector& x) {
  for (int i = size; i-- > 0;) {
    double sum = x[i];
    for (int k = i + 1; k < size; ++k) sum -= r(i, k) * x[k];
    x[i] = sum * r(i, i);
  }
}

}  // namespace

void Forest::load_mass(int body) {
  const TreeBody& of = bodies_[body];
  Block<6, 6>& mass = nodes_[body].mass;
  mass.setZero();
  for (int i = 0; i < 3; ++i) mass(i, i) = of.mass;
  mass.bottomRightCorner<3, 3>() = of.inertia;
}

void Forest::factor(int first, int last) {
  nodes_.resize(bodies_.size());
  for (int body = first; body < last; ++body) nodes_[body].is_stale = true;
  refactor(first, last);
}

void Forest::change_joint(int body) {
  for (int at = body; at >= 0; at = bodies_[at].parent) nodes_[at].is_stale = true;
}

/// A parent's mass is the sum over its children in one order, whichever of them are factored again.
void Forest::refactor(int first, int last) {
  for (int body = first; body < last; ++body)
    if (nodes_[body].is_stale) load_mass(body);
  for (int body = last; body-- > first;) {
    if (nodes_[body].is_stale) factor_body(body);
    nodes_[body].is_stale = false;
    const int parent = bodies_[body].parent;
    if (parent >= 0 && nodes_[parent].is_stale) add_to_parent(body);
  }
}

/// Eliminates a body and its joint.
void Forest::factor_body(int body) {
  const TreeBody& of = bodies_[body];
  Node& node = nodes_[body];
  factor_symmetric<6>(node.mass, 6);
  constexpr std::size_t usual = 6;
  if (of.joint.empty()) return;
  of.joint.size() <= usual ? eliminate_joint<usual>(of, node) : eliminate_joint<padded>(of, node);
}

template <int Rows>
void Forest::eliminate_joint(const TreeBody& of, Node& node) {
  const int rows = static_cast<int>(of.joint.size());
  // own = R'^-1 first'
  for (int k = 0; k < 6; ++k) {
    auto line = node.own_by_row.row(k).template head<Rows>();
    line.setZero();
    for (int r = 0; r < rows; ++r) line[r] = of.joint[r].first[k];
    for (int i = 0; i < k; ++i) line -= node.mass(i, k) * node.own_by_row.row(i).template head<Rows>();
    line *= node.mass(k, k);
  }
  // inner = own' own + softness
  for (int r = 0; r < rows; ++r) {
    auto line = node.inner.row(r).template head<Rows>();
    line = node.own_by_row(0, r) * node.own_by_row.row(0).template head<Rows>();
    for (int k = 1; k < 6; ++k) line += node.own_by_row(k, r) * node.own_by_row.row(k).template head<Rows>();
    line[r] += of.joint[r].softness;
  }
  factor_symmetric<Rows>(node.inner, rows);
  for (int r = 0; r < rows; ++r) {
    auto line = node.own.row(r);
    for (int k = 0; k < 6; ++k) line[k] = node.own_by_row(k, r);
    for (int s = 0; s < r; ++s) line -= node.inner(s, r) * node.own.row(s);
    line *= node.inner(r, r);
  }
  for (int k = 0; k < 6; ++k)
    for (int r = 0; r < rows; ++r) node.own_by_row(k, r) = node.own(r, k);
  if (of.parent < 0) return;
  for (int r = 0; r < rows; ++r) {
    auto line = node.above.row(r);
    line = of.joint[r].second.transpose();
    for (int s = 0; s < r; ++s) line -= node.inner(s, r) * node.above.row(s);
    line *= node.inner(r, r);
  }
}

/// The parent's mass becomes that of an articulated body.
void Forest::add_to_parent(int body) {
  const Node& node = nodes_[body];
  Block<6, 6>& parent = nodes_[bodies_[body].parent].mass;
  const int rows = static_cast<int>(bodies_[body].joint.size());
  for (int r = 0; r < rows; ++r) {
    const auto line = node.above.row(r);
    for (int i = 0; i < 6; ++i) parent.row(i) += line[i] * line;
  }
}

void Forest::climb(int body, Vector6d& t, Rest& u, Vector6d* to_parent) const {
  const Node& node = nodes_[body];
  const int rows = static_cast<int>(bodies_[body].joint.size());
  solve_transposed(node.mass, 6, t);
  if (rows == 0) return;
  constexpr int usual = 6;
  if (rows <= usual)
    for (int k = 0; k < 6; ++k) u.head<usual>() -= t[k] * node.own_by_row.row(k).head<usual>().transpose();
  else
    for (int k = 0; k < 6; ++k) u -= t[k] * node.own_by_row.row(k).transpose();
  if (!to_parent) return;
  for (int r = 0; r < rows; ++r) *to_parent += u[r] * node.above.row(r).transpose();
}

void Forest::solve(int first, int last) {
  for (int body = first; body < last; ++body) nodes_[body].t = bodies_[body].momentum;
  for (int body = last; body-- > first;) {
    Node& node = nodes_[body];
    const JointRows& joint = bodies_[body].joint;
    for (std::size_t r = 0; r < joint.size(); ++r) node.u[r] = joint[r].target;
    solve_transposed(node.inner, static_cast<int>(joint.size()), node.u);
    const int parent = bodies_[body].parent;
    climb(body, node.t, node.u, parent < 0 ? nullptr : &nodes_[parent].t);
  }
  descend(first, last);
}

void Forest::push(int body, const Vector6d& momentum) {
  Vector6d t = momentum, next;
  for (int at = body; at >= 0; at = bodies_[at].parent, t = next) {
    Rest u = Rest::Zero();
    next.setZero();
    climb(at, t, u, &next);
    nodes_[at].t += t;
    nodes_[at].u += u;
  }
}

void Forest::descend(int first, int last) {
  for (int body = first; body < last; ++body) {
    Node& node = nodes_[body];
    const int rows = static_cast<int>(bodies_[body].joint.size());
    const int parent = bodies_[body].parent;
    node.velocity = node.t;
    for (int r = 0; r < rows; ++r) {
      double u = node.u[r];
      if (parent >= 0) u -= dot6(node.above.row(r), nodes_[parent].velocity);
      node.velocity += u * node.own.row(r).transpose();
      node.impulses[r] = u;
    }
    solve_upper(node.inner, rows, node.impulses);
    solve_upper(node.mass, 6, node.velocity);
  }
}

void Forest::climb(int body, UnitHalf& half, Block<6, 6>* to_parent) const {
  const Node& node = nodes_[body];
  const int rows = static_cast<int>(bodies_[body].joint.size());
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) half.t.row(i) -= node.mass(k, i) * half.t.row(k);
    half.t.row(i) *= node.mass(i, i);
  }
  for (int r = 0; r < rows; ++r) {
    half.u.row(r) = -node.own(r, 0) * half.t.row(0);
    for (int k = 1; k < 6; ++k) half.u.row(r) -= node.own(r, k) * half.t.row(k);
  }
  if (!to_parent) return;
  for (int k = 0; k < 6; ++k) {
    to_parent->row(k).setZero();
    for (int r = 0; r < rows; ++r) to_parent->row(k) += node.above(r, k) * half.u.row(r);
  }
}

void Forest::clear_columns() {
  groups_.clear();
  singles_ = units_ = 0;
}

int Forest::add_unit_columns(int body) {
  const std::size_t begin = units_++ * bodies_.size();
  if (unit_halves_.size() < begin + bodies_.size()) unit_halves_.resize(begin + bodies_.size());
  groups_.push_back({body, true, begin});
  unit_halves_[begin + body].t.setIdentity();
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    const int parent = bodies_[at].parent;
    climb(at, unit_halves_[begin + at], parent < 0 ? nullptr : &unit_halves_[begin + parent].t);
  }
  return static_cast<int>(groups_.size()) - 1;
}

int Forest::add_column(int body, const Vector6d& on_body, const Vector6d& on_parent) {
  const std::size_t begin = singles_++ * bodies_.size();
  if (halves_.size() < begin + bodies_.size()) halves_.resize(begin + bodies_.size());
  groups_.push_back({body, false, begin});
  halves_[begin + body].t = on_body;
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    Half& half = halves_[begin + at];
    half.u.setZero();
    const int parent = bodies_[at].parent;
    if (parent < 0) {
      climb(at, half.t, half.u, nullptr);
      break;
    }
    Vector6d& next = halves_[begin + parent].t;
    next = at == body ? on_parent : Vector6d(Vector6d::Zero());
    climb(at, half.t, half.u, &next);
  }
  return static_cast<int>(groups_.size()) - 1;
}

/// From `body` to the root: the sum of t' t - u' u.
template <class First, class Second>
void Forest::multiply(int body, const First* first, const Second* second, double* place, std::size_t stride) const {
  using Lines = std::remove_const_t<decltype(first->t)>;
  constexpr int width = Lines::ColsAtCompileTime, other_width = decltype(second->t)::ColsAtCompileTime;
  using Line = Eigen::Matrix<double, 1, other_width>;
  std::array<Line, width> sums;
  for (Line& sum : sums) sum.setZero();
  for (int at = body; at >= 0; at = bodies_[at].parent) {
    const First& a = first[at];
    const Second& b = second[at];
    const int rows = static_cast<int>(bodies_[at].joint.size());
    for (int i = 0; i < width; ++i) {
      for (int k = 0; k < 6; ++k) sums[i] += a.t(k, i) * b.t.row(k);
      for (int r = 0; r < rows; ++r) sums[i] -= a.u(r, i) * b.u.row(r);
    }
  }
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < other_width; ++j) place[i * stride + j] = sums[i][j];
}

void Forest::multiply(int group, int other, double* place, std::size_t stride) const {
  const Group &first = groups_[group], &second = groups_[other];
  int a = first.body, b = second.body;
  while (a != b && a >= 0 && b >= 0) {  // to the first body that both paths contain; parents have smaller indices
    int& lower = a > b ? a : b;
    lower = bodies_[lower].parent;
  }
  const int common = a == b ? a : -1;
  const auto units = [&](const Group& of) { return unit_halves_.data() + of.begin; };
  const auto single = [&](const Group& of) { return halves_.data() + of.begin; };
  if (first.is_units && second.is_units) return multiply(common, units(first), units(second), place, stride);
  if (first.is_units) return multiply(common, units(first), single(second), place, stride);
  if (second.is_units) return multiply(common, single(first), units(second), place, stride);
  return multiply(common, single(first), single(second), place, stride);
}

}  // namespace rehearse
