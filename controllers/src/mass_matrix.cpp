// The mass matrix by composite inertias: R. Featherstone: Rigid Body Dynamics Algorithms, 2008, chapter 6.

#include <cnoid/Body>
#include <cnoid/MassMatrix>

#include <cstddef>
#include <vector>

#include "composite_inertia.h"

namespace cnoid {

namespace {

int numRootRows(const Body& body) { return body.isFixedRootModel() ? 0 : 6; }

/// What calcInverseDynamics writes, and what it is given here in place of the body's own.
class SavedMotion {
 public:
  explicit SavedMotion(Body& body) : body_(body) {
    for (const auto& link : body.links()) {
      State state;
      state.dv = link->dv();
      state.dw = link->dw();
      state.u = link->u();
      state.ddq = link->ddq();
      states_.push_back(state);
    }
  }
  ~SavedMotion() {
    for (int i = 0; i < body_.numLinks(); ++i) {
      const State& state = states_[static_cast<std::size_t>(i)];
      Link& link = *body_.link(i);
      link.dv() = state.dv;
      link.dw() = state.dw;
      link.u() = state.u;
      link.ddq() = state.ddq;
    }
  }
  SavedMotion(const SavedMotion&) = delete;
  SavedMotion& operator=(const SavedMotion&) = delete;

 private:
  struct State {
    Vector3 dv, dw;
    double u, ddq;
  };
  Body& body_;
  std::vector<State> states_;
};

}  // namespace

void calcMassMatrix(Body* body, MatrixXd& out_M) {
  const int root = numRootRows(*body);
  const Vector3 about = body->rootLink()->p();
  const CompositeInertias composites = compositeInertias(*body);
  out_M.setZero(root + body->numJoints(), root + body->numJoints());
  if (root) {
    for (int i = 0; i < 6; ++i) out_M.col(i).head<6>() = composites[0].momentum(Vector6::Unit(i));
  }
  for (int id = 0; id < body->numJoints(); ++id) {
    const Link& joint = *body->joint(id);
    const int column = root + id;
    if (joint.isValid() && joint.hasActualJoint()) {
      const auto& moved = composites[static_cast<std::size_t>(joint.index())];
      const Vector6 momentum = moved.momentum(jointMotion(joint, about));
      for (const Link* link = &joint; link; link = link->parent()) {
        if (link->jointId() < 0 || body->joint(link->jointId()) != link) continue;
        const int row = root + link->jointId();
        out_M(row, column) = out_M(column, row) = jointMotion(*link, about).dot(momentum);
      }
      if (root) {
        out_M.col(column).head<6>() = momentum;
        out_M.row(column).head<6>() = momentum.transpose();
      }
    }
    out_M(column, column) += joint.Jm2();
  }
}

void calcMassMatrix(Body* body, const Vector3& g, MatrixXd& out_M, VectorXd& out_b) {
  calcMassMatrix(body, out_M);
  const SavedMotion saved(*body);
  for (const auto& joint : body->joints()) {
    if (joint->isValid()) joint->ddq() = 0.0;
  }
  Link& root = *body->rootLink();
  root.dv() = g;
  root.dw().setZero();
  for (const auto& link : body->links()) link->u() = 0.0;  // of fixed joints with an id
  const Vector6 wrench = LinkTraverse(body->linkTraverse()).calcInverseDynamics();
  const int rows = numRootRows(*body);
  out_b.setZero(rows + body->numJoints());
  if (rows) out_b.head<6>() << wrench.head<3>(), wrench.tail<3>() - root.p().cross(Vector3(wrench.head<3>()));
  for (int id = 0; id < body->numJoints(); ++id)
    out_b[rows + id] = body->joint(id)->isValid() ? body->joint(id)->u() : 0.0;
}

}  // namespace cnoid
