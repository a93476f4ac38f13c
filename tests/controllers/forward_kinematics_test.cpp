// Velocities and accelerations are checked against differences of poses: they must be the derivatives of one motion.
#include <gtest/gtest.h>
#include <cnoid/Body>
#include <cnoid/EigenUtil>

#include "bodies.h"

namespace {

using cnoid::Body;
using cnoid::BodyPtr;
using cnoid::Matrix3;
using cnoid::Vector3;

/// The whole arm at a time t [s] of a smooth motion of its base and both its joints.
void move_to(Body& body, double t) {
  cnoid::Link* base = body.rootLink();
  base->setTranslation(Vector3(0.3 * t * t, 0.2 * t, 1.0));
  base->v() = Vector3(0.6 * t, 0.2, 0.0);
  base->dv() = Vector3(0.6, 0.0, 0.0);
  base->setRotation(cnoid::AngleAxis(0.5 * t * t, Vector3::UnitZ()));
  base->w() = Vector3(0, 0, t);
  base->dw() = Vector3(0, 0, 1);
  body.joint(0)->q() = std::sin(t);
  body.joint(0)->dq() = std::cos(t);
  body.joint(0)->ddq() = -std::sin(t);
  body.joint(1)->q() = t * t;
  body.joint(1)->dq() = 2 * t;
  body.joint(1)->ddq() = 2;
  body.calcForwardKinematics(true, true);
}

constexpr double step = 1.0e-5;       // [s] of the differences
constexpr double tolerance = 1.0e-7;  // their error is of the order of step², times accelerations of about 10

TEST(ForwardKinematics, PlacesALinkByItsOffsetAndItsJoint) {
  const BodyPtr body = rehearse::test::make_arm();
  body->joint(0)->q() = cnoid::PI_2;  // about y: x turns to -z
  body->joint(1)->q() = 0.5;
  body->calcForwardKinematics();
  EXPECT_TRUE(body->link("ARM")->p().isApprox(Vector3(0, 0, 1)));
  EXPECT_TRUE(body->link("HAND")->p().isApprox(Vector3(0, 0, 1 - 2.5), 1e-15));
  EXPECT_TRUE(body->link("TOOL")->R().isApprox(body->link("ARM")->R()));
}

TEST(ForwardKinematics, GivesVelocitiesThatAreTheDerivativesOfThePoses) {
  const BodyPtr body = rehearse::test::make_arm();
  cnoid::Link* hand = body->link("HAND");
  move_to(*body, 0.7 - step);
  const Vector3 p_before = hand->p();
  const Matrix3 R_before = hand->R();
  move_to(*body, 0.7 + step);
  const Vector3 p_after = hand->p();
  const Matrix3 R_after = hand->R();
  move_to(*body, 0.7);
  EXPECT_TRUE(hand->v().isApprox((p_after - p_before) / (2 * step), tolerance));
  const Matrix3 spin = (R_after - R_before) / (2 * step) * hand->R().transpose();
  EXPECT_TRUE(hand->w().isApprox(Vector3(spin(2, 1), spin(0, 2), spin(1, 0)), tolerance));
}

TEST(ForwardKinematics, GivesAccelerationsThatAreTheDerivativesOfTheVelocities) {
  const BodyPtr body = rehearse::test::make_arm();
  cnoid::Link* hand = body->link("HAND");
  move_to(*body, 0.7 - step);
  const Vector3 v_before = hand->v();
  const Vector3 w_before = hand->w();
  move_to(*body, 0.7 + step);
  const Vector3 v_after = hand->v();
  const Vector3 w_after = hand->w();
  move_to(*body, 0.7);
  EXPECT_TRUE(hand->dv().isApprox((v_after - v_before) / (2 * step), tolerance));
  EXPECT_TRUE(hand->dw().isApprox((w_after - w_before) / (2 * step), tolerance));
}

TEST(ForwardKinematics, LeavesVelocitiesAloneUnlessAsked) {
  const BodyPtr body = rehearse::test::make_arm();
  body->joint(0)->dq() = 1.0;
  body->calcForwardKinematics();
  EXPECT_TRUE(body->link("HAND")->v().isZero(0.0));
}

}  // namespace
