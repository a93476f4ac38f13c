#include <gtest/gtest.h>
#include <cnoid/JointTraverse>
#include <cnoid/LinkPath>
#include <cnoid/LinkTraverse>

#include <stdexcept>
#include <string>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::JointTraverse;
using cnoid::Link;
using cnoid::LinkTraverse;
using rehearse::test::make_arm;
using rehearse::test::make_biped;
using rehearse::test::stir;

template <class Links>
std::string names(const Links& links) {
  std::string names;
  for (const auto& link : links) names += (names.empty() ? "" : " ") + link->name();
  return names;
}

TEST(LinkTraverse, HasTheLinkAndThoseBelowIt) {
  const BodyPtr body = make_arm();
  const LinkTraverse traverse(body->link("ARM"));
  EXPECT_EQ(names(traverse), "ARM HAND TOOL");
  EXPECT_TRUE(traverse.hasRootLowerLinks());
  EXPECT_FALSE(traverse.hasRootUpperLinks());
  EXPECT_EQ(traverse.body(), body);
  EXPECT_EQ(traverse.rootLink(), body->link("ARM"));
}

TEST(LinkTraverse, ClimbsToTheRootBeforeItDescends) {
  const BodyPtr body = make_arm();
  const LinkTraverse traverse(body->link("HAND"), true, true);
  EXPECT_EQ(names(traverse), "HAND ARM BASE TOOL");
  EXPECT_FALSE(traverse.isDownward(0));
  EXPECT_FALSE(traverse.isDownward(1));
  EXPECT_TRUE(traverse.isDownward(2));
  EXPECT_TRUE(traverse.hasRootUpperLinks());
  EXPECT_EQ(names(LinkTraverse(body->link("ARM"), true, false)), "ARM BASE");
  EXPECT_EQ(names(LinkTraverse(body->link("ARM"), false, false)), "ARM");
}

TEST(LinkTraverse, OfTheRootIsTheBodysOwn) {
  const BodyPtr body = make_biped();
  EXPECT_EQ(names(LinkTraverse(body->rootLink())), names(body->linkTraverse()));
  EXPECT_EQ(names(body->linkTraverse()), names(body->links()));
}

TEST(LinkTraverse, RefusesANullLink) { EXPECT_THROW(LinkTraverse(nullptr), std::invalid_argument); }

TEST(LinkTraverse, ComputesEveryLinkFromAnyOfThem) {
  const BodyPtr body = make_biped();
  stir(*body);
  const BodyPtr other = body->clone();
  for (const auto& link : other->links()) {
    if (link->name() == "LEFT4") continue;
    link->T().setIdentity();
    link->v().setZero();
    link->w().setZero();
    link->dv().setZero();
    link->dw().setZero();
  }
  LinkTraverse(other->link("LEFT4"), true, true).calcForwardKinematics(true, true);
  for (const auto& link : body->links()) {
    const Link& same = *other->link(link->index());
    EXPECT_TRUE(same.T().isApprox(link->T(), 1e-12)) << link->name();
    EXPECT_TRUE(same.v().isApprox(link->v(), 1e-12)) << link->name();
    EXPECT_TRUE(same.w().isApprox(link->w(), 1e-12)) << link->name();
    EXPECT_TRUE(same.dv().isApprox(link->dv(), 1e-11)) << link->name();
    EXPECT_TRUE(same.dw().isApprox(link->dw(), 1e-11)) << link->name();
  }
}

TEST(LinkTraverse, IsBuiltLinkByLink) {
  const BodyPtr body = make_arm();
  LinkTraverse traverse;
  traverse.append(body->link("ARM"));
  traverse.append(body->link("BASE"), false);
  traverse.append(body->link("TOOL"));
  traverse.insertRoot(body->link("HAND"));
  EXPECT_EQ(names(traverse), "HAND ARM BASE TOOL");
  EXPECT_FALSE(traverse.isDownward(1));
  EXPECT_TRUE(traverse.isDownward(2));
  EXPECT_THROW(traverse.append(body->link("BASE"), false), std::invalid_argument);
  traverse.clear();
  EXPECT_TRUE(traverse.empty());
  EXPECT_EQ(traverse.body(), nullptr);
}

TEST(LinkTraverse, KeepsTheLinksThatOthersAreComputedFromOnTheWayUp) {
  const BodyPtr body = make_arm();
  LinkTraverse traverse(body->link("HAND"), true, true);
  EXPECT_FALSE(traverse.remove(body->link("ARM")));
  EXPECT_FALSE(traverse.remove(4));
  EXPECT_TRUE(traverse.remove(body->link("TOOL")));
  EXPECT_FALSE(traverse.remove(body->link("TOOL")));
  EXPECT_TRUE(traverse.remove(body->link("HAND")));
  EXPECT_EQ(names(traverse), "ARM BASE");
  EXPECT_FALSE(traverse.isDownward(0));
}

TEST(LinkTraverse, IsTheBaseOfALinkPath) {
  const BodyPtr body = make_arm();
  const cnoid::LinkPath path(body->link("HAND"), body->link("TOOL"));
  const LinkTraverse& traverse = path;
  EXPECT_EQ(names(traverse), "HAND ARM TOOL");
  EXPECT_TRUE(traverse.hasRootUpperLinks());
}

TEST(JointTraverse, OfABodyHasItsJointsById) {
  const BodyPtr body = make_biped();
  const JointTraverse joints(body);
  EXPECT_EQ(joints.numLinks(), body->numLinks());
  ASSERT_EQ(joints.numJoints(), 14);
  for (int id = 0; id < 14; ++id) EXPECT_EQ(joints.joint(id), body->joint(id));
}

TEST(JointTraverse, FromALinkHasTheJointsOfThoseLinks) {
  const BodyPtr body = make_biped();
  JointTraverse joints(body->link("CHEST"), true, true);
  EXPECT_EQ(names(joints.joints()).substr(0, 12), "CHEST RIGHT1");
  EXPECT_EQ(joints.numJoints(), 15);
  EXPECT_EQ(joints.jointAtIdOrder(0), body->link("ANTENNA"));  // its id is -1
  EXPECT_EQ(joints.jointAtIdOrder(1), body->joint(0));
  EXPECT_THROW(joints.jointAtIdOrder(15), std::out_of_range);
  EXPECT_FALSE(joints.appendJoint(body->rootLink()));
  EXPECT_TRUE(joints.remove(body->link("HEAD")));
  EXPECT_EQ(joints.numJoints(), 14);
  EXPECT_FALSE(joints.remove(body->link("HEAD")));
}

}  // namespace
