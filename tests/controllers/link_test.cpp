#include <gtest/gtest.h>
#include <cnoid/Link>
#include <cnoid/SimpleController>

#include "bodies.h"

namespace {

using cnoid::AngleAxis;
using cnoid::Isometry3;
using cnoid::Link;
using cnoid::LinkPtr;
using cnoid::Matrix3;
using cnoid::Quaternion;
using cnoid::SimpleController;
using cnoid::Vector3;
using cnoid::Vector6;
using rehearse::test::make_link;

TEST(LinkStateFlag, HasTheBitsOfChoreonoid) {
  EXPECT_EQ(Link::StateNone, 0);
  EXPECT_EQ(Link::JointDisplacement, 1);
  EXPECT_EQ(Link::JointVelocity, 2);
  EXPECT_EQ(Link::JointAcceleration, 4);
  EXPECT_EQ(Link::JointEffort, 8);
  EXPECT_EQ(Link::LinkPosition, 16);
  EXPECT_EQ(Link::LinkTwist, 32);
  EXPECT_EQ(Link::LinkAcceleration, 64);
  EXPECT_EQ(Link::LinkExtWrench, 128);
  EXPECT_EQ(Link::LinkContactState, 256);
  EXPECT_EQ(Link::HighGainActuation, 512);
  EXPECT_EQ(Link::DeprecatedJointSurfaceVelocity, 1024);
}

TEST(LinkStateFlag, HasItsSynonyms) {
  EXPECT_EQ(Link::JointAngle, Link::JointDisplacement);
  EXPECT_EQ(Link::JointTorque, Link::JointEffort);
  EXPECT_EQ(Link::JointForce, Link::JointEffort);
}

TEST(LinkStateFlag, StillKnowsTheOldNames) {
  EXPECT_EQ(Link::NO_ACTUATION, Link::StateNone);
  EXPECT_EQ(Link::JOINT_TORQUE, Link::JointTorque);
  EXPECT_EQ(Link::JOINT_FORCE, Link::JointForce);
  EXPECT_EQ(Link::JOINT_EFFORT, Link::JointEffort);
  EXPECT_EQ(Link::JOINT_ANGLE, Link::JointAngle);
  EXPECT_EQ(Link::JOINT_DISPLACEMENT, Link::JointDisplacement);
  EXPECT_EQ(Link::JOINT_VELOCITY, Link::JointVelocity);
  EXPECT_EQ(Link::LINK_POSITION, Link::LinkPosition);
  EXPECT_EQ(Link::JOINT_SURFACE_VELOCITY, 1024);
}

TEST(SimpleControllerStateType, RepeatsTheFlagsOfLink) {
  EXPECT_EQ(int{SimpleController::JointTorque}, int{Link::JointTorque});
  EXPECT_EQ(int{SimpleController::JointAngle}, int{Link::JointAngle});
  EXPECT_EQ(int{SimpleController::LinkContactState}, int{Link::LinkContactState});
  EXPECT_EQ(int{SimpleController::JOINT_TORQUE}, int{Link::JointTorque});
  EXPECT_EQ(int{SimpleController::JOINT_SURFACE_VELOCITY}, 1024);
  EXPECT_EQ(int{SimpleController::LINK_FORCE}, int{Link::LinkExtWrench});
}

TEST(Link, StartsAsAFixedLinkOfOneKilogramWithoutLimits) {
  const LinkPtr link = new Link;
  EXPECT_TRUE(link->isFixedJoint());
  EXPECT_EQ(link->jointId(), -1);
  EXPECT_EQ(link->index(), -1);
  EXPECT_FALSE(link->isValid());
  EXPECT_EQ(link->mass(), 1.0);
  EXPECT_EQ(link->I(), Matrix3::Identity());
  EXPECT_FALSE(link->hasJointDisplacementLimits());
  EXPECT_FALSE(link->hasJointVelocityLimits());
  EXPECT_FALSE(link->hasJointEffortLimits());
  EXPECT_EQ(link->T().matrix(), Isometry3::Identity().matrix());
}

TEST(Link, IsFixedAsAPseudoContinuousTrackToo) {
  const LinkPtr link = make_link("TRACK", Link::PseudoContinuousTrackJoint);
  EXPECT_TRUE(link->isFixedJoint());
  EXPECT_FALSE(link->hasActualJoint());
  EXPECT_STREQ(link->jointTypeSymbol(), "pseudo_continuous_track");
  EXPECT_STREQ(link->jointTypeLabel(), "pseudo continuous track");
}

TEST(Link, CombinesFlagsInItsModes) {
  const LinkPtr link = new Link;
  link->setActuationMode(Link::JointEffort | Link::JointDisplacement);
  EXPECT_EQ(link->actuationMode(), 9);
  link->setSensingMode(Link::LinkTwist);
  link->mergeSensingMode(Link::LinkPosition);
  EXPECT_EQ(link->sensingMode(), 48);
}

TEST(Link, SetsItsPoseFromEigensExpressions) {
  const LinkPtr link = new Link;
  const AngleAxis quarter_turn(1.5707963267948966, Vector3::UnitZ());
  link->setTranslation(Eigen::Vector3f(1, 2, 3));
  link->setRotation(quarter_turn);
  EXPECT_EQ(link->translation(), Vector3(1, 2, 3));
  EXPECT_TRUE(link->rotation().isApprox(quarter_turn.toRotationMatrix()));
  link->setRotation(Quaternion(quarter_turn).inverse());
  EXPECT_TRUE(link->R().isApprox(quarter_turn.toRotationMatrix().transpose()));
  link->p() += Vector3(1, 0, 0);
  EXPECT_EQ(link->position().translation(), Vector3(2, 2, 3));
  link->setPosition(Matrix3::Identity(), Vector3(4, 5, 6));
  EXPECT_TRUE(link->T().isApprox(Isometry3(Eigen::Translation3d(4, 5, 6))));
  const cnoid::Position pose = link->position();
  link->setPosition(Isometry3::Identity());
  link->setPosition(pose.matrix());
  EXPECT_TRUE(link->T().isApprox(pose));
}

TEST(Link, TakesExternalForcesAboutTheWorldsOrigin) {
  const LinkPtr link = new Link;
  link->setTranslation(Vector3(0, 0, 2));
  link->addExternalForceAtLocalPosition(Vector3(3, 0, 0), Vector3(0, 0, 1));
  Vector6 expected;
  expected << 3, 0, 0, 0, 9, 0;  // 3 N along x, 3 m above the origin
  EXPECT_EQ(link->F_ext(), expected);
  link->addExternalForce(Vector3(3, 0, 0), Vector3(0, 0, 1));
  EXPECT_EQ(link->externalWrench(), 2 * expected);
  EXPECT_EQ(link->f_ext(), Vector3(6, 0, 0));
  EXPECT_EQ(link->tau_ext(), Vector3(0, 18, 0));
}

TEST(Link, InitializesItsStateWhereItStands) {
  const LinkPtr link = new Link;
  link->q() = 0.5;
  link->dq() = link->ddq() = link->u() = link->dq_target() = 7.0;
  link->v() = link->w() = link->dv() = link->dw() = Vector3::Ones();
  link->F_ext().setOnes();
  link->initializeState();
  EXPECT_EQ(link->q(), 0.5);
  EXPECT_EQ(link->q_target(), 0.5);
  EXPECT_EQ(link->dq() + link->ddq() + link->u() + link->dq_target(), 0.0);
  EXPECT_TRUE((link->v() + link->w() + link->dv() + link->dw()).isZero(0.0));
  EXPECT_TRUE(link->F_ext().isZero(0.0));
}

TEST(Link, HasLimitsIfBothSidesAreLimited) {
  const LinkPtr link = new Link;
  link->setJointRange(std::numeric_limits<double>::lowest(), 1.0);
  EXPECT_FALSE(link->hasJointDisplacementLimits());
  EXPECT_TRUE(Link::isUnlimitedRangeValue(link->q_lower()));
  link->setJointRange(-1.0, 1.0);
  link->setJointVelocityRange(-2.0, 2.0);
  link->setJointEffortRange(-3.0, 3.0);
  EXPECT_TRUE(link->hasJointDisplacementLimits());
  EXPECT_TRUE(link->hasJointVelocityLimits());
  EXPECT_TRUE(link->hasJointEffortLimits());
  link->setUnlimitedJointDisplacementRange();
  EXPECT_FALSE(link->hasJointDisplacementLimits());
}

TEST(Link, KeepsChildrenInTheOrderInWhichTheyWereAppended) {
  const LinkPtr parent = make_link("P", Link::FreeJoint);
  Link* second = make_link("B", Link::FixedJoint);
  Link* first = make_link("A", Link::FixedJoint);
  parent->appendChild(second);
  parent->prependChild(first);
  EXPECT_EQ(parent->child(), first);
  EXPECT_EQ(first->sibling(), second);
  EXPECT_EQ(second->sibling(), nullptr);
  EXPECT_EQ(second->parent(), parent);
}

TEST(Link, MovesAChildFromItsOldParent) {
  const LinkPtr old_parent = make_link("OLD", Link::FreeJoint);
  const LinkPtr new_parent = make_link("NEW", Link::FreeJoint);
  Link* child = make_link("CHILD", Link::FixedJoint);
  old_parent->appendChild(child);
  new_parent->appendChild(child);
  EXPECT_EQ(old_parent->child(), nullptr);
  EXPECT_EQ(child->parent(), new_parent);
}

TEST(Link, RemovesOnlyItsOwnChildren) {
  const LinkPtr parent = make_link("P", Link::FreeJoint);
  const LinkPtr child = make_link("C", Link::FixedJoint);
  EXPECT_FALSE(parent->removeChild(child));
  parent->appendChild(child);
  EXPECT_TRUE(parent->removeChild(child));
  EXPECT_EQ(child->parent(), nullptr);
  EXPECT_TRUE(parent->isEndLink());
}

TEST(Link, LeavesAHeldChildBehindWithoutAParent) {
  LinkPtr parent = make_link("P", Link::FreeJoint);
  const LinkPtr child = make_link("C", Link::FixedJoint);
  parent->appendChild(make_link("B", Link::FixedJoint));
  parent->appendChild(child);
  parent.reset();
  EXPECT_TRUE(child->isRoot());
}

TEST(Link, KnowsWhatCarriesIt) {
  const cnoid::BodyPtr body = rehearse::test::make_arm();
  EXPECT_TRUE(body->link("TOOL")->isOwnerOf(body->link("ARM")));
  EXPECT_TRUE(body->link("TOOL")->isOwnerOf(body->link("TOOL")));
  EXPECT_FALSE(body->link("ARM")->isOwnerOf(body->link("TOOL")));
  EXPECT_FALSE(body->link("TOOL")->isFixedToRoot());
  EXPECT_TRUE(body->rootLink()->isFixedToRoot());
  EXPECT_FALSE(body->rootLink()->isStatic());
}

TEST(Link, CopiesEverythingButItsPlace) {
  const cnoid::BodyPtr body = rehearse::test::make_arm();
  Link* arm = body->link("ARM");
  arm->q() = 0.25;
  arm->q_target() = 0.5;
  arm->setActuationMode(Link::JointEffort);
  arm->setJointRange(-1, 1);
  const LinkPtr copy = arm->clone();
  EXPECT_EQ(copy->name(), "ARM");
  EXPECT_EQ(copy->jointName(), "SHOULDER");
  EXPECT_EQ(copy->jointId(), 0);
  EXPECT_EQ(copy->q(), 0.25);
  EXPECT_EQ(copy->q_target(), 0.5);
  EXPECT_EQ(copy->actuationMode(), Link::JointEffort);
  EXPECT_EQ(copy->q_upper(), 1.0);
  EXPECT_EQ(copy->b(), Vector3(0, 0, 1));
  EXPECT_EQ(copy->parent(), nullptr);
  EXPECT_EQ(copy->child(), nullptr);
  EXPECT_EQ(copy->body(), nullptr);
  EXPECT_EQ(copy->index(), -1);
}

TEST(LinkContactPoint, TellsWhatItWasMadeOf) {
  const LinkPtr link = new Link;
  link->contactPoints().emplace_back(Vector3(1, 0, 0), Vector3(0, 0, 1), Vector3(0, 0, 5), Vector3(0, 2, 0), 0.001);
  const Link::ContactPoint& point = link->contactPoints().front();
  EXPECT_EQ(point.position(), Vector3(1, 0, 0));
  EXPECT_EQ(point.normal(), Vector3(0, 0, 1));
  EXPECT_EQ(point.force(), Vector3(0, 0, 5));
  EXPECT_EQ(point.velocity(), Vector3(0, 2, 0));
  EXPECT_EQ(point.depth(), 0.001);
}

TEST(Link, HasTheMaterialOfItsModel) {
  const cnoid::LinkPtr link = new cnoid::Link;
  EXPECT_EQ(link->materialName(), "Default");
  link->setMaterial("Ground");
  const cnoid::LinkPtr copy = link->clone();
  EXPECT_EQ(copy->materialName(), "Ground");
  link->setMaterial("");
  EXPECT_EQ(link->materialName(), "Default");
}

TEST(Link, HasTheNamesOfEarlierReleasesForItsPose) {
  const cnoid::LinkPtr link = new cnoid::Link;
  const cnoid::Matrix3 turn = cnoid::AngleAxis(0.7, cnoid::Vector3::UnitX()).toRotationMatrix();
  link->setAttitude(turn);
  link->p() = cnoid::Vector3(1, 2, 3);
  EXPECT_EQ(link->attitude(), turn);
  EXPECT_EQ(link->calcRfromAttitude(turn), turn);
  EXPECT_EQ(link->Ta().matrix(), link->T().matrix());
  cnoid::Isometry3 pose;
  link->getAttitudeAndTranslation(pose);
  EXPECT_EQ(pose.matrix(), link->T().matrix());
  const cnoid::Link::ActuationMode mode = cnoid::Link::JointEffort;
  link->setActuationMode(mode);
  EXPECT_EQ(link->actuationMode(), cnoid::Link::JointEffort);
}

}  // namespace
