// Inverse kinematics of whole bodies: several base links, feet, and groups of links.

#include <gtest/gtest.h>
#include <cnoid/CompositeIK>
#include <cnoid/JointPath>
#include <cnoid/LeggedBodyHelper>
#include <cnoid/LinkGroup>
#include <cnoid/YAMLReader>

#include <stdexcept>
#include <string>
#include <vector>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::CompositeIK;
using cnoid::Isometry3;
using cnoid::LeggedBodyHelper;
using cnoid::Link;
using cnoid::Vector3;
using rehearse::test::make_biped;

double distance(const Isometry3& a, const Isometry3& b) { return (a.matrix() - b.matrix()).norm(); }

/// The poses that forward kinematics gives from the waist, which is where it is.
std::vector<double> gaps_to_forward_kinematics(const cnoid::Body& body) {
  const BodyPtr copy = body.clone();
  copy->calcForwardKinematics();
  std::vector<double> gaps;
  for (const auto& link : body.links()) gaps.push_back(distance(link->T(), copy->link(link->index())->T()));
  return gaps;
}

TEST(CompositeIK, MovesALinkWhileTheBaseLinksStay) {
  const BodyPtr body = make_biped();
  const Isometry3 left = body->link("LEFT6")->T(), right = body->link("RIGHT6")->T();
  CompositeIK ik(body, body->rootLink());
  ASSERT_TRUE(ik.addBaseLink(body->link("LEFT6")));
  ASSERT_TRUE(ik.addBaseLink(body->link("RIGHT6")));
  EXPECT_EQ(ik.numJointPaths(), 2);
  EXPECT_EQ(ik.baseLink(1), body->link("RIGHT6"));
  Isometry3 goal = body->rootLink()->T();
  goal.pretranslate(Vector3(0.03, 0.02, -0.05));
  goal.rotate(cnoid::AngleAxis(0.1, Vector3::UnitZ()));
  ASSERT_TRUE(ik.calcInverseKinematics(goal));
  EXPECT_EQ(body->rootLink()->T().matrix(), goal.matrix());
  EXPECT_TRUE(ik.calcRemainingPartForwardKinematicsForInverseKinematics());
  for (const double gap : gaps_to_forward_kinematics(*body)) EXPECT_LT(gap, 1e-6);
  body->calcForwardKinematics();
  EXPECT_LT(distance(body->link("LEFT6")->T(), left), 1e-6);
  EXPECT_LT(distance(body->link("RIGHT6")->T(), right), 1e-6);
}

TEST(CompositeIK, LeavesTheBodyAsItWasIfOneLegCantReach) {
  const BodyPtr body = make_biped();
  const BodyPtr before = body->clone();
  CompositeIK ik(body, body->rootLink());
  ik.addBaseLink(body->link("LEFT6"));
  ik.addBaseLink(body->link("RIGHT6"));
  Isometry3 goal = body->rootLink()->T();
  goal.pretranslate(Vector3(0, 0.9, 0));
  EXPECT_FALSE(ik.calcInverseKinematics(goal));
  for (const auto& link : body->links()) {
    EXPECT_EQ(link->T().matrix(), before->link(link->index())->T().matrix());
    EXPECT_EQ(link->q(), before->link(link->index())->q());
  }
}

TEST(CompositeIK, NeedsABaseLinkWithAPath) {
  const BodyPtr body = make_biped(), other = make_biped();
  CompositeIK ik(body, body->rootLink());
  EXPECT_FALSE(ik.addBaseLink(nullptr));
  EXPECT_FALSE(ik.addBaseLink(other->link("LEFT6")));
  EXPECT_FALSE(ik.calcInverseKinematics(body->rootLink()->T()));
  EXPECT_FALSE(ik.calcRemainingPartForwardKinematicsForInverseKinematics());
}

TEST(CompositeIK, RefusesPathsThatShareAJoint) {
  const BodyPtr body = make_biped();
  CompositeIK ik(body, body->link("CHEST"));
  EXPECT_TRUE(ik.addBaseLink(body->link("LEFT6")));
  EXPECT_FALSE(ik.addBaseLink(body->link("RIGHT6")));  // both lead through the joint of CHEST
  EXPECT_EQ(ik.numJointPaths(), 1);
  EXPECT_EQ(LeggedBodyHelper(body).getFootBasedIK(body->link("CHEST")), nullptr);
}

TEST(JointPath, MovesTheRestOfTheBodyAfterASolution) {
  const BodyPtr body = make_biped();
  cnoid::JointPath path(body->link("LEFT6"), body->rootLink());
  Isometry3 goal = body->rootLink()->T();
  goal.pretranslate(Vector3(0.02, 0, -0.03));
  ASSERT_TRUE(path.calcInverseKinematics(goal));
  EXPECT_GT(gaps_to_forward_kinematics(*body)[static_cast<std::size_t>(body->link("HEAD")->index())], 1e-3);
  EXPECT_TRUE(path.calcRemainingPartForwardKinematicsForInverseKinematics());
  for (const double gap : gaps_to_forward_kinematics(*body)) EXPECT_LT(gap, 1e-6);
}

TEST(LeggedBodyHelper, ReadsTheFeetFromTheBodysInformation) {
  const BodyPtr body = make_biped();
  const LeggedBodyHelper legged(body);
  ASSERT_TRUE(legged.isValid());
  ASSERT_EQ(legged.numFeet(), 2);
  EXPECT_EQ(legged.footLink(LeggedBodyHelper::Left), body->link("LEFT6"));
  EXPECT_EQ(legged.kneePitchJoint(0), nullptr);
  EXPECT_EQ(legged.homeCopOfSoleLocal(1), Vector3(0.05, 0, -0.08));
  EXPECT_TRUE(legged.centerOfSole(0).isApprox(body->link("LEFT6")->T() * Vector3(0.05, 0, -0.08)));
  EXPECT_TRUE(legged.centerOfSoles().isApprox((legged.centerOfSole(0) + legged.centerOfSole(1)) / 2));
  EXPECT_THROW(legged.footLink(2), std::out_of_range);
}

TEST(LeggedBodyHelper, ReadsAllKeysOfAFoot) {
  cnoid::YAMLReader reader;
  ASSERT_TRUE(
      reader.parse("footLinks:\n  - {link: RIGHT6, soleCenter: [1, 2, 3], homeCop: [4, 5, 6], toe_offset: [7, 8, 9], "
                   "kneePitchJoint: RIGHT4}\n"));
  const BodyPtr body = make_biped();
  body->resetInfo(reader.document()->toMapping());
  const LeggedBodyHelper legged(body);
  ASSERT_EQ(legged.numFeet(), 1);
  EXPECT_EQ(legged.centerOfSoleLocal(0), Vector3(1, 2, 3));
  EXPECT_EQ(legged.homeCopOfSoleLocal(0), Vector3(4, 5, 6));
  EXPECT_EQ(Vector3(legged.toeOffset(0).translation()), Vector3(7, 8, 9));
  EXPECT_EQ(legged.kneePitchJoint(0), body->link("RIGHT4"));
}

TEST(LeggedBodyHelper, ReportsAFootThatItCantUse) {
  const BodyPtr body = make_biped();
  const auto read = [&body](const std::string& text) {
    cnoid::YAMLReader reader;
    EXPECT_TRUE(reader.parse(text));
    body->resetInfo(reader.document()->toMapping());
    LeggedBodyHelper helper(body);
  };
  EXPECT_THROW(read("foot_links: [{link: NOSE, sole_center: [0, 0, 0]}]"), std::invalid_argument);
  EXPECT_THROW(read("foot_links: [{link: LEFT6}]"), cnoid::ValueNode::Exception);
  EXPECT_THROW(read("foot_links: [{link: LEFT6, sole_center: [0, 0]}]"), cnoid::ValueNode::Exception);
  EXPECT_NO_THROW(read("name: nobody"));
}

TEST(LeggedBodyHelper, OfABodyWithoutFeetIsNotValid) {
  const BodyPtr body = rehearse::test::make_arm();
  LeggedBodyHelper legged(body);
  EXPECT_FALSE(legged.isValid());
  EXPECT_FALSE(legged.doLegIkToMoveCm(Vector3::Zero()));
  EXPECT_FALSE(legged.setStance(0.2, nullptr));
  EXPECT_EQ(legged.getFootBasedIK(body->rootLink()), nullptr);
  EXPECT_EQ(legged.getOrCreateZmpDevice(), nullptr);
  EXPECT_THROW(legged.centerOfSoles(), std::logic_error);
}

TEST(LeggedBodyHelper, IsKeptWithTheBody) {
  const BodyPtr body = make_biped();
  LeggedBodyHelper* legged = cnoid::getLeggedBodyHelper(body);
  EXPECT_TRUE(legged->isValid());
  EXPECT_EQ(cnoid::getLeggedBodyHelper(body), legged);
}

TEST(LeggedBodyHelper, MovesTheCentreOfMassOverTheFeet) {
  const BodyPtr body = make_biped();
  const Isometry3 left = body->link("LEFT6")->T(), right = body->link("RIGHT6")->T();
  const auto turn = body->rootLink()->R().eval();
  LeggedBodyHelper legged(body);
  const Vector3 goal = legged.centerOfSoles();
  const double height = body->calcCenterOfMass().z();
  ASSERT_TRUE(legged.doLegIkToMoveCm(goal, true));
  EXPECT_LT((body->calcCenterOfMass() - goal).head<2>().norm(), 1e-6);
  EXPECT_NEAR(body->centerOfMass().z(), height, 0.05);
  EXPECT_LT(distance(body->link("LEFT6")->T(), left), 1e-6);
  EXPECT_LT(distance(body->link("RIGHT6")->T(), right), 1e-6);
  EXPECT_TRUE(body->rootLink()->R().isApprox(turn, 1e-9));
  EXPECT_FALSE(legged.doLegIkToMoveCm(goal + Vector3(0, 0, 2)));
  EXPECT_LT((body->calcCenterOfMass() - goal).head<2>().norm(), 1e-6);
}

TEST(LeggedBodyHelper, SetsTheWidthOfTheStance) {
  const BodyPtr body = make_biped();
  LeggedBodyHelper legged(body);
  Link* right = body->link("RIGHT6");
  const Isometry3 standing = right->T();
  ASSERT_TRUE(legged.setStance(0.3, right));
  EXPECT_LT(distance(right->T(), standing), 1e-6);
  EXPECT_LT((body->link("LEFT6")->p() - right->p() - 0.3 * standing.linear().col(1)).norm(), 2e-2);
  EXPECT_NEAR((body->link("LEFT6")->p() - right->p()).norm(), 0.3, 1e-6);
  EXPECT_GT(body->link("LEFT6")->p().y(), right->p().y());
  EXPECT_NEAR(body->rootLink()->p().y(), (body->link("LEFT6")->p().y() + right->p().y()) / 2, 1e-6);
  for (const double gap : gaps_to_forward_kinematics(*body)) EXPECT_LT(gap, 1e-6);
  EXPECT_FALSE(legged.setStance(3.0, right));
  EXPECT_NEAR((body->link("LEFT6")->p() - right->p()).norm(), 0.3, 1e-6);
}

TEST(LeggedBodyHelper, StoresAZmpInADeviceOfTheBody) {
  const BodyPtr body = make_biped();
  LeggedBodyHelper legged(body);
  EXPECT_EQ(legged.zmp(), Vector3(0, 0, 0));
  bool told = false;
  legged.getOrCreateZmpDevice()->sigStateChanged().connect([&told] { told = true; });
  legged.setZmp(Vector3(1, 2, 3), true);
  EXPECT_TRUE(told);
  EXPECT_EQ(legged.zmp(), Vector3(1, 2, 3));
  auto* device = body->findDevice<cnoid::ZmpDevice>();
  ASSERT_NE(device, nullptr);
  double numbers[4];
  device->writeState(numbers);
  const cnoid::ZmpDevicePtr other = new cnoid::ZmpDevice;
  EXPECT_EQ(other->readState(numbers, 3), numbers);
  other->readState(numbers, 4);
  EXPECT_EQ(other->zmp(), Vector3(1, 2, 3));
  EXPECT_TRUE(other->on());
  other->clearState();
  other->copyStateFrom(*device);
  EXPECT_EQ(other->zmp(), Vector3(1, 2, 3));
}

TEST(LinkGroup, OfABodyWithoutGroupsHasAllLinks) {
  const BodyPtr body = rehearse::test::make_arm();
  const cnoid::LinkGroupPtr group = cnoid::LinkGroup::create(body);
  EXPECT_EQ(group->name(), "Whole Body");
  ASSERT_EQ(group->numElements(), 4);
  EXPECT_TRUE(group->checkIfLink(3));
  EXPECT_EQ(group->linkIndex(3), 3);
}

TEST(LinkGroup, HasTheGroupsOfTheBodysInformation) {
  cnoid::YAMLReader reader;
  ASSERT_TRUE(reader.parse(
      "link_group:\n- BASE\n- NOBODY\n- name: UPPER\n  links:\n    - ARM\n    - {name: ENDS, links: [HAND, TOOL]}\n"));
  const BodyPtr body = rehearse::test::make_arm();
  body->resetInfo(reader.document()->toMapping());
  const cnoid::LinkGroupPtr group = cnoid::LinkGroup::create(body);
  ASSERT_EQ(group->numElements(), 2);
  EXPECT_EQ(group->linkIndex(0), 0);
  ASSERT_TRUE(group->checkIfGroup(1));
  EXPECT_EQ(group->group(1)->name(), "UPPER");
  cnoid::LinkGroup* ends = group->findSubGroup("ENDS");
  ASSERT_NE(ends, nullptr);
  EXPECT_EQ(ends->linkIndex(1), body->link("TOOL")->index());
  EXPECT_EQ(group->findSubGroup("NOBODY"), nullptr);
}

}  // namespace
