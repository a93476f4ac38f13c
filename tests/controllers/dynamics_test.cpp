// Mass matrix and inverse dynamics against mechanics on paper, energy, momentum, and each other.

#include <gtest/gtest.h>
#include <cnoid/InverseDynamics>
#include <cnoid/LinkTraverse>
#include <cnoid/MassMatrix>

#include <Eigen/Cholesky>

#include <cmath>
#include <stdexcept>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::Link;
using cnoid::LinkTraverse;
using cnoid::MatrixXd;
using cnoid::Vector3;
using cnoid::Vector6;
using cnoid::VectorXd;
using rehearse::test::advance;
using rehearse::test::make_biped;
using rehearse::test::make_link;
using rehearse::test::stir;

const Vector3 up(0, 0, 9.80665);

double kinetic_energy(const cnoid::Body& body) {
  double energy = 0.0;
  for (const auto& link : body.links()) {
    const Vector3 v = link->v() + link->w().cross(link->R() * link->c());
    const Vector3 w = link->R().transpose() * link->w();
    energy +=
        0.5 * link->m() * v.squaredNorm() + 0.5 * w.dot(link->I() * w) + 0.5 * link->Jm2() * link->dq() * link->dq();
  }
  return energy;
}

double potential_energy(cnoid::Body& body) { return body.mass() * up.dot(body.calcCenterOfMass()); }

/// Root's velocities, then those of joints by id; ANTENNA, which has no id, doesn't move.
VectorXd velocities(const cnoid::Body& body) {
  VectorXd all(6 + body.numJoints());
  all << body.rootLink()->v(), body.rootLink()->w(), VectorXd::Zero(body.numJoints());
  for (int id = 0; id < body.numJoints(); ++id) all[6 + id] = body.joint(id)->dq();
  return all;
}

VectorXd accelerations(const cnoid::Body& body) {
  VectorXd all(6 + body.numJoints());
  all << body.rootLink()->dv(), body.rootLink()->dw(), VectorXd::Zero(body.numJoints());
  for (int id = 0; id < body.numJoints(); ++id) all[6 + id] = body.joint(id)->ddq();
  return all;
}

BodyPtr make_moving_biped() {
  const BodyPtr body = make_biped();
  body->link("ANTENNA")->dq() = 0.0;
  stir(*body);
  return body;
}

/// Two rods in the x-z plane, joints about y, hanging at q = 0. Their lengths, masses and inertias differ.
struct DoublePendulum {
  static constexpr double l1 = 0.7, c1 = 0.3, c2 = 0.25, m1 = 2.0, m2 = 1.5, i1 = 0.08, i2 = 0.03, j1 = 0.02, j2 = 0.01;
  BodyPtr body = new cnoid::Body("pendulum");

  DoublePendulum() {
    Link* base = make_link("BASE", Link::FixedJoint);
    Link* parent = base;
    body->setRootLink(base);
    const double masses[] = {m1, m2}, centers[] = {c1, c2}, inertias[] = {i1, i2}, rotors[] = {j1, j2};
    for (int i = 0; i < 2; ++i) {
      Link* rod = make_link("ROD" + std::to_string(i + 1), Link::RevoluteJoint, i);
      rod->setJointAxis(Vector3::UnitY());
      if (i == 1) rod->setOffsetTranslation(Vector3(0, 0, -l1));
      rod->setMass(masses[i]);
      rod->setCenterOfMass(Vector3(0, 0, -centers[i]));
      rod->setInertia(Vector3(0.5, inertias[i], 0.4).asDiagonal());
      rod->setEquivalentRotorInertia(rotors[i]);
      parent->appendChild(rod);
      parent = rod;
    }
    body->updateLinkTree();
    body->initializePosition();
  }

  void set(const Vector3& first, const Vector3& second) {  // q, dq, ddq
    const Vector3 values[] = {first, second};
    for (int i = 0; i < 2; ++i) {
      body->joint(i)->q() = values[i][0];
      body->joint(i)->dq() = values[i][1];
      body->joint(i)->ddq() = values[i][2];
    }
    body->calcForwardKinematics(true, true);
  }
};

TEST(InverseDynamics, OfADoublePendulumIsLagranges) {
  using P = DoublePendulum;
  P pendulum;
  const double q1 = 0.6, q2 = -1.1, w1 = 1.7, w2 = -2.3, a1 = 0.9, a2 = 3.1, g = up.z();
  pendulum.set({q1, w1, a1}, {q2, w2, a2});
  pendulum.body->rootLink()->dv() = up;
  calcInverseDynamics(pendulum.body->rootLink());
  const double coupling = P::m2 * P::l1 * P::c2;
  const double inner = P::i2 + P::m2 * P::c2 * P::c2;
  const double outer = P::i1 + P::m1 * P::c1 * P::c1 + P::m2 * P::l1 * P::l1 + inner;
  const double u2 = (inner + P::j2) * a2 + (inner + coupling * std::cos(q2)) * a1 + coupling * std::sin(q2) * w1 * w1 +
                    P::m2 * g * P::c2 * std::sin(q1 + q2);
  const double u1 = (outer + P::j1 + 2 * coupling * std::cos(q2)) * a1 + (inner + coupling * std::cos(q2)) * a2 -
                    coupling * std::sin(q2) * (2 * w1 * w2 + w2 * w2) +
                    (P::m1 * P::c1 + P::m2 * P::l1) * g * std::sin(q1) + P::m2 * g * P::c2 * std::sin(q1 + q2);
  EXPECT_NEAR(pendulum.body->joint(0)->u(), u1, 1e-12);
  EXPECT_NEAR(pendulum.body->joint(1)->u(), u2, 1e-12);
}

TEST(MassMatrix, OfADoublePendulumIsLagranges) {
  using P = DoublePendulum;
  P pendulum;
  const double q2 = -1.1;
  pendulum.set({0.6, 0, 0}, {q2, 0, 0});
  MatrixXd M;
  calcMassMatrix(pendulum.body, M);
  ASSERT_EQ(M.rows(), 2);
  ASSERT_EQ(M.cols(), 2);
  const double coupling = P::m2 * P::l1 * P::c2;
  const double inner = P::i2 + P::m2 * P::c2 * P::c2;
  EXPECT_NEAR(M(1, 1), inner + P::j2, 1e-14);
  EXPECT_NEAR(M(0, 1), inner + coupling * std::cos(q2), 1e-14);
  EXPECT_NEAR(M(0, 0),
              P::i1 + P::m1 * P::c1 * P::c1 + P::m2 * P::l1 * P::l1 + inner + 2 * coupling * std::cos(q2) + P::j1,
              1e-14);
}

TEST(MassMatrix, GivesTheKineticEnergy) {
  const BodyPtr body = make_moving_biped();
  body->link("ANTENNA")->dq() = 0.0;
  body->calcForwardKinematics(true);
  MatrixXd M;
  calcMassMatrix(body, M);
  ASSERT_EQ(M.rows(), 20);
  EXPECT_TRUE(M.isApprox(M.transpose(), 1e-14));
  const VectorXd speed = velocities(*body);
  EXPECT_NEAR(0.5 * speed.dot(M * speed), kinetic_energy(*body), 1e-12 * kinetic_energy(*body));
  EXPECT_EQ(Eigen::LLT<MatrixXd>(M).info(), Eigen::Success);  // positive definite
}

TEST(MassMatrix, HasTheColumnsOfInverseDynamics) {
  const BodyPtr body = make_moving_biped();
  MatrixXd M;
  VectorXd b;
  calcMassMatrix(body, up, M, b);
  // M times the accelerations, plus b, is what inverse dynamics gives for them.
  const BodyPtr other = body->clone();
  other->link("ANTENNA")->ddq() = body->link("ANTENNA")->ddq();
  other->rootLink()->dv() += up;
  const Vector6 wrench = calcInverseDynamics(other->rootLink());
  const VectorXd efforts = M * accelerations(*body) + b;
  const Vector3 force = wrench.head<3>();
  EXPECT_TRUE(efforts.head<3>().isApprox(force, 1e-12));
  EXPECT_TRUE(efforts.segment<3>(3).isApprox(wrench.tail<3>() - other->rootLink()->p().cross(force), 1e-11));
  for (int id = 0; id < body->numJoints(); ++id) EXPECT_NEAR(efforts[6 + id], other->joint(id)->u(), 1e-10) << id;
}

TEST(MassMatrix, LeavesAccelerationsAndEffortsOfTheBodyAlone) {
  const BodyPtr body = make_moving_biped();
  for (const auto& link : body->links()) link->u() = 0.5;
  const BodyPtr before = body->clone();
  MatrixXd M;
  VectorXd b;
  calcMassMatrix(body, up, M, b);
  for (const auto& link : body->links()) {
    const Link& same = *before->link(link->index());
    EXPECT_EQ(link->dv(), same.dv());
    EXPECT_EQ(link->dw(), same.dw());
    EXPECT_EQ(link->ddq(), same.ddq());
    EXPECT_EQ(link->u(), 0.5);
  }
}

TEST(MassMatrix, HasAnEmptyRowForAnIdWithoutAJoint) {
  DoublePendulum pendulum;
  pendulum.body->joint(1)->setJointId(2);
  pendulum.body->updateLinkTree();
  MatrixXd M;
  calcMassMatrix(pendulum.body, M);
  ASSERT_EQ(M.rows(), 3);
  EXPECT_TRUE(M.row(1).isZero(0.0));
  EXPECT_TRUE(M.col(1).isZero(0.0));
  EXPECT_GT(M(2, 0), 0.0);
}

TEST(MassMatrix, HasTheGradientOfThePotentialEnergyAsItsBiasAtRest) {
  const BodyPtr body = make_biped();
  MatrixXd M;
  VectorXd b;
  calcMassMatrix(body, up, M, b);
  EXPECT_TRUE(b.head<3>().isApprox(body->mass() * up, 1e-12));
  const double step = 1e-5;
  for (int id = 0; id < body->numJoints(); ++id) {
    const auto energy_at = [&body, id](double change) {
      const BodyPtr moved = body->clone();
      moved->joint(id)->q() += change;
      moved->calcForwardKinematics();
      return potential_energy(*moved);
    };
    EXPECT_NEAR(b[6 + id], (energy_at(step) - energy_at(-step)) / (2 * step), 1e-6) << id;
  }
}

TEST(InverseDynamics, GivesTheWrenchThatChangesTheMomentum) {
  const BodyPtr body = make_moving_biped();
  const double step = 1e-5;
  const auto momentum_at = [&body](double time) {
    const BodyPtr moved = body->clone();
    advance(*moved, time);
    moved->calcCenterOfMass();
    Vector3 P, L;
    moved->calcTotalMomentum(P, L);
    return (Vector6() << P, L).finished();
  };
  const Vector6 change = (momentum_at(step) - momentum_at(-step)) / (2 * step);
  EXPECT_TRUE(calcInverseDynamics(body->rootLink()).isApprox(change, 1e-7));
}

TEST(InverseDynamics, GivesThePowerThatChangesTheEnergy) {
  const BodyPtr body = make_moving_biped();
  const double step = 1e-5;
  const auto energy_at = [&body](double time) {
    const BodyPtr moved = body->clone();
    advance(*moved, time);
    return kinetic_energy(*moved) + potential_energy(*moved);
  };
  const double change = (energy_at(step) - energy_at(-step)) / (2 * step);
  Link& root = *body->rootLink();
  root.dv() += up;
  const Vector6 wrench = calcInverseDynamics(&root);
  const Vector3 force = wrench.head<3>();
  double power = force.dot(root.v()) + (wrench.tail<3>() - root.p().cross(force)).dot(root.w());
  for (const auto& joint : body->allJoints()) power += joint->u() * joint->dq();
  EXPECT_NEAR(power, change, 1e-6 * std::abs(change));
}

TEST(InverseDynamics, CountsExternalForcesOnLinks) {
  const BodyPtr body = make_moving_biped();
  const BodyPtr pushed = body->clone();
  const Vector6 without = calcInverseDynamics(body->rootLink());
  Link& hand = *pushed->link("HEAD");
  const Vector3 force(3, -4, 5), place = hand.p();
  hand.addExternalForceAtGlobalPosition(force, place);
  const Vector6 with = calcInverseDynamics(pushed->rootLink());
  EXPECT_TRUE((without - with).head<3>().isApprox(force, 1e-12));
  EXPECT_TRUE((without - with).tail<3>().isApprox(place.cross(force), 1e-12));
  // The joint below the force has the moment of the force less; a leg has the same.
  const Link& chest = *pushed->link("CHEST");
  const double moment = (chest.R() * chest.a()).dot((place - chest.p()).cross(force));
  EXPECT_NEAR(body->link("CHEST")->u() - chest.u(), moment, 1e-11);
  EXPECT_NEAR(body->link("LEFT3")->u(), pushed->link("LEFT3")->u(), 1e-12);
}

TEST(InverseDynamics, OfALinkIsThatOfThePartBelowIt) {
  const BodyPtr body = make_moving_biped();
  calcInverseDynamics(body->rootLink());
  const BodyPtr other = body->clone();
  for (const auto& link : other->links()) link->u() = 0.0;
  calcInverseDynamics(other->link("RIGHT3"));
  for (const char* name : {"RIGHT3", "RIGHT5", "RIGHT6"})
    EXPECT_NEAR(other->link(name)->u(), body->link(name)->u(), 1e-11) << name;
  EXPECT_EQ(other->link("RIGHT2")->u(), 0.0);
}

TEST(InverseDynamics, FromAFootIsThatOfABodyOnThisFoot) {
  const BodyPtr body = make_moving_biped();
  const BodyPtr standing = body->clone();
  const Vector6 wrench = calcInverseDynamics(body->rootLink());
  LinkTraverse from_foot(standing->link("LEFT6"), true, true);
  EXPECT_TRUE(from_foot.calcInverseDynamics().isApprox(wrench, 1e-10));
  // The whole wrench acts on the foot: the joints of its leg carry it, the others are as before.
  const Vector3 force = wrench.head<3>();
  for (const auto& joint : standing->allJoints()) {
    double carried = 0.0;
    if (joint->name().substr(0, 4) == "LEFT")
      carried = (joint->R() * joint->a()).dot(Vector3(wrench.tail<3>() - joint->p().cross(force)));
    EXPECT_NEAR(joint->u(), body->link(joint->index())->u() - carried, 1e-9) << joint->name();
  }
}

TEST(InverseDynamics, RefusesLinksWithoutTheirParents) {
  const BodyPtr body = make_biped();
  LinkTraverse traverse(body->rootLink());
  traverse.remove(body->link("CHEST"));
  EXPECT_THROW(traverse.calcInverseDynamics(), std::logic_error);
}

}  // namespace
