// Jacobians against differences of forward kinematics and of momentum.

#include <gtest/gtest.h>
#include <cnoid/EigenUtil>
#include <cnoid/Jacobian>

#include <stdexcept>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::Isometry3;
using cnoid::JointPath;
using cnoid::Link;
using cnoid::Matrix3;
using cnoid::MatrixXd;
using cnoid::Vector3;
using cnoid::Vector6;
using rehearse::test::make_biped;
using rehearse::test::stir;

constexpr double small_step = 1e-6;

BodyPtr make_stirred_biped() {
  const BodyPtr body = make_biped();
  stir(*body);
  return body;
}

/// A copy with a joint moved; with a base link the whole body is moved so that this link is where it was.
BodyPtr moved(const cnoid::Body& body, int id, double change, const Link* base) {
  const BodyPtr copy = body.clone();
  copy->joint(id)->q() += change;
  copy->calcForwardKinematics();
  if (base) {
    const Isometry3 root = base->T() * copy->link(base->index())->T().inverse() * copy->rootLink()->T();
    copy->rootLink()->T() = root;
    copy->calcForwardKinematics();
  }
  return copy;
}

/// Velocity of the point that is fixed to the link, and angular velocity, from two poses.
Vector6 velocity(const Isometry3& before, const Isometry3& after, const Vector3& local, double time) {
  Vector6 all;
  all.head<3>() = (after * local - before * local) / time;
  all.tail<3>() = before.linear() * cnoid::omegaFromRot(before.linear().transpose() * after.linear()) / time;
  return all;
}

void set_velocities(cnoid::Body& body, int column, const Link* base) {
  for (const auto& joint : body.allJoints()) joint->dq() = 0.0;
  Link& root = *body.rootLink();
  root.v().setZero();
  root.w().setZero();
  const int n = body.numJoints();
  if (column < n) body.joint(column)->dq() = 1.0;
  if (column >= n) (column < n + 3 ? root.v() : root.w())[(column - n) % 3] = 1.0;
  body.calcForwardKinematics(true);
  if (!base) return;
  const Vector3 w = base->w(), v = base->v() + w.cross(root.p() - base->p());
  root.w() -= w;
  root.v() -= v;
  body.calcForwardKinematics(true);
}

class JacobianOfThe : public testing::TestWithParam<const char*> {};

TEST_P(JacobianOfThe, CentreOfMassIsItsDerivative) {
  const BodyPtr body = make_stirred_biped();
  Link* base = body->link(GetParam());  // null for ""
  MatrixXd J;
  calcCMJacobian(body, base, J);
  ASSERT_EQ(J.cols(), base ? 14 : 20);
  for (int id = 0; id < 14; ++id) {
    const Vector3 difference = moved(*body, id, small_step, base)->calcCenterOfMass() -
                               moved(*body, id, -small_step, base)->calcCenterOfMass();
    EXPECT_LT((J.col(id) - difference / (2 * small_step)).norm(), 1e-9) << id << ": " << J.col(id).transpose();
  }
}

TEST_P(JacobianOfThe, MomentumIsTheMomentumOfEachVelocity) {
  const BodyPtr body = make_stirred_biped();
  Link* base = body->link(GetParam());
  MatrixXd H, J;
  calcAngularMomentumJacobian(body, base, H);
  calcCMJacobian(body, base, J);
  ASSERT_EQ(H.cols(), J.cols());
  const Vector3 about = base ? Vector3::Zero() : body->calcCenterOfMass();
  body->calcCenterOfMass();
  for (int column = 0; column < H.cols(); ++column) {
    set_velocities(*body, column, base);
    Vector3 P, L;
    body->calcTotalMomentum(P, L);
    EXPECT_LT((J.col(column) - P / body->mass()).norm(), 1e-13) << column;
    EXPECT_LT((H.col(column) - (L - about.cross(P))).norm(), 1e-12) << column;
  }
}

INSTANTIATE_TEST_SUITE_P(OfABiped, JacobianOfThe, testing::Values("", "LEFT6", "RIGHT3", "HEAD", "WAIST"));

TEST(Jacobian, OfALinkIsItsDerivativeUpAndDownAPath) {
  const BodyPtr body = make_stirred_biped();
  Link* base = body->link("LEFT6");
  const Vector3 local(0.1, -0.2, 0.3);
  const JointPath path(base, body->link("RIGHT6"));
  ASSERT_EQ(path.numJoints(), 12);
  // The end, links on the way up and down, and one beside the path.
  for (const char* name : {"RIGHT6", "RIGHT2", "LEFT3", "LEFT6", "WAIST", "HEAD"}) {
    Link* target = body->link(name);
    MatrixXd J = MatrixXd::Constant(6, 12, 7.0);
    cnoid::setJacobian<0x3f, 0, 0, true>(path, target, local, J);
    for (int i = 0; i < 12; ++i) {
      const int id = path.joint(i)->jointId();
      const Isometry3 before = moved(*body, id, -small_step, base)->link(name)->T();
      const Isometry3 after = moved(*body, id, small_step, base)->link(name)->T();
      EXPECT_LT((J.col(i) - velocity(before, after, local, 2 * small_step)).norm(), 1e-8) << name << " " << i;
    }
  }
}

TEST(Jacobian, OfTheCentreOfMassRefusesABaseLinkOfAnotherBody) {
  const BodyPtr body = make_stirred_biped(), other = make_biped();
  MatrixXd J;
  EXPECT_THROW(calcCMJacobian(body, other->link("LEFT6"), J), std::invalid_argument);
}

TEST(Jacobian, IsThatOfThePathForItsEnd) {
  const BodyPtr body = make_stirred_biped();
  const JointPath path(body->link("CHEST"), body->link("RIGHT6"));
  MatrixXd J(6, path.numJoints()), same;
  cnoid::setJacobian<0x3f, 0, 0>(path, body->link("RIGHT6"), J);
  path.calcJacobian(same);
  EXPECT_TRUE(J.isApprox(same, 1e-14));
}

TEST(Jacobian, HasTheRowsOfTheMaskAtTheGivenPlace) {
  const BodyPtr body = make_stirred_biped();
  const JointPath path(body->rootLink(), body->link("HEAD"));
  ASSERT_EQ(path.numJoints(), 2);
  MatrixXd whole(6, 2), part = MatrixXd::Constant(5, 4, 7.0);
  cnoid::setJacobian<0x3f, 0, 0>(path, body->link("HEAD"), whole);
  cnoid::setJacobian<0x2a, 1, 2>(path, body->link("HEAD"), part);  // y, and x and z of the angular velocity
  EXPECT_EQ(part.block(1, 2, 1, 2), whole.row(1));
  EXPECT_EQ(part.block(2, 2, 1, 2), whole.row(3));
  EXPECT_EQ(part.block(3, 2, 1, 2), whole.row(5));
  part.block(1, 2, 3, 2).setConstant(7.0);
  EXPECT_TRUE((part.array() == 7.0).all());
}

}  // namespace
