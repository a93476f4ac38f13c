#include "forest.h"

#include <cmath>
#include <cstddef>

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
  for (int body = first; body < last; ++body) load_mass(body);
  for (int body = last; body-- > first;) factor_body(body);
}

/// Eliminates a body and its joint. The parent's mass becomes that of an articulated body.
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
  Block<6, 6>& parent = nodes_[of.parent].mass;
  for (int r = 0; r < rows; ++r) {
    auto line = node.above.row(r);
    line = of.joint[r].second.transpose();
    for (int s = 0; s < r; ++s) line -= node.inner(s, r) * node.above.row(s);
    line *= node.inner(r, r);
    for (int i = 0; i < 6; ++i) parent.row(i) += line[i] * line;
  }
}

void Forest::climb(int body, Vector6d& t, Rest& u, Vector6d* to_parent) const {
  const Node& node = nodes_[body];
  const int rows = static_cast<int>(bodies_[body].joint.size());
  solve_transposed(node.mass, 6, t);
  if (rows == 0) return;
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

int Forest::add_column(int body, const Vector6d& on_body, const Vector6d* on_parent) {
  const auto column = static_cast<int>(column_bodies_.size());
  column_bodies_.push_back(body);
  const std::size_t begin = static_cast<std::size_t>(column) * bodies_.size();
  if (halves_.size() < begin + bodies_.size()) halves_.resize(begin + bodies_.size());
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
    next = at == body && on_parent ? *on_parent : Vector6d(Vector6d::Zero());
    climb(at, half.t, half.u, &next);
  }
  return column;
}

double Forest::product(int column, int other) const {
  int a = column_bodies_[column], b = column_bodies_[other];
  while (a != b) {  // to the first body that both paths contain; parents have smaller indices
    int& lower = a > b ? a : b;
    lower = bodies_[lower].parent;
    if (lower < 0) return 0.0;
  }
  const Half* first = &halves_[static_cast<std::size_t>(column) * bodies_.size()];
  const Half* second = &halves_[static_cast<std::size_t>(other) * bodies_.size()];
  double sum = 0.0;
  for (; a >= 0; a = bodies_[a].parent) {
    for (int k = 0; k < 6; ++k) sum += first[a].t[k] * second[a].t[k];
    for (std::size_t r = 0; r < bodies_[a].joint.size(); ++r) sum -= first[a].u[r] * second[a].u[r];
  }
  return sum;
}

}  // namespace rehearse
