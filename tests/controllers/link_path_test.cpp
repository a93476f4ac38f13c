#include <gtest/gtest.h>
#include <cnoid/LinkPath>

#include <stdexcept>
#include <string>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::LinkPath;
using cnoid::Vector3;

std::string names(const LinkPath& path) {
  std::string names;
  for (const auto& link : path) names += (names.empty() ? "" : " ") + link->name();
  return names;
}

TEST(LinkPath, LeadsUpToWhereTheTwoWaysMeetAndDownAgain) {
  const BodyPtr body = rehearse::test::make_arm();
  const LinkPath path(body->link("HAND"), body->link("TOOL"));
  EXPECT_EQ(names(path), "HAND ARM TOOL");
  EXPECT_FALSE(path.isDownward(0));
  EXPECT_TRUE(path.isDownward(1));
  EXPECT_EQ(path.baseLink(), body->link("HAND"));
  EXPECT_EQ(path.endLink(), body->link("TOOL"));
  EXPECT_EQ(path.body(), body);
}

TEST(LinkPath, LeadsDownFromTheRootIfOnlyTheEndIsGiven) {
  const BodyPtr body = rehearse::test::make_arm();
  const LinkPath path(body->link("HAND"));
  EXPECT_EQ(names(path), "BASE ARM HAND");
  EXPECT_TRUE(path.isDownward(0));
}

TEST(LinkPath, ClimbsFromALinkToOneThatCarriesIt) {
  const BodyPtr body = rehearse::test::make_arm();
  const LinkPath path(body->link("HAND"), body->rootLink());
  EXPECT_EQ(names(path), "HAND ARM BASE");
  EXPECT_FALSE(path.isDownward(1));
}

TEST(LinkPath, OfALinkToItselfIsThatLink) {
  const BodyPtr body = rehearse::test::make_arm();
  EXPECT_EQ(names(LinkPath(body->link("ARM"), body->link("ARM"))), "ARM");
}

TEST(LinkPath, DoesNotLeadFromOneBodyToAnother) {
  const BodyPtr body = rehearse::test::make_arm();
  const BodyPtr other = rehearse::test::make_arm();
  LinkPath path(body->link("HAND"));
  EXPECT_FALSE(path.setPath(body->link("HAND"), other->link("HAND")));
  EXPECT_TRUE(path.empty());
  EXPECT_EQ(path.baseLink(), nullptr);
}

TEST(LinkPath, RefusesANullLink) {
  const BodyPtr body = rehearse::test::make_arm();
  EXPECT_THROW(LinkPath(body->rootLink(), body->link("NO SUCH LINK")), std::invalid_argument);
}

/// The arm in motion, with all velocities and accelerations known from the root on.
BodyPtr moving_arm() {
  BodyPtr body = rehearse::test::make_arm();
  cnoid::Link* base = body->rootLink();
  base->setRotation(cnoid::AngleAxis(0.4, Vector3(1, 2, 2) / 3.0));
  base->v() = Vector3(0.1, -0.2, 0.3);
  base->w() = Vector3(0.5, 0.25, -1.0);
  base->dv() = Vector3(1, 2, 3);
  base->dw() = Vector3(-0.5, 0.75, 0.25);
  for (cnoid::Link* joint : body->joints()) {
    joint->q() = 0.3 + joint->jointId();
    joint->dq() = -0.7 + joint->jointId();
    joint->ddq() = 1.1 + joint->jointId();
  }
  body->calcForwardKinematics(true, true);
  return body;
}

TEST(LinkPath, MovesAsTheBodyDoesInWhicheverDirection) {
  const BodyPtr expected = moving_arm();
  for (const auto& [base, end] : {std::pair("BASE", "HAND"), std::pair("HAND", "BASE"), std::pair("HAND", "TOOL")}) {
    const BodyPtr body = expected->clone();
    for (const auto& link : body->links()) {
      if (link->name() == base) continue;
      link->T() = cnoid::Isometry3::Identity();
      link->v().setZero();
      link->w().setZero();
      link->dv().setZero();
      link->dw().setZero();
    }
    LinkPath path(body->link(std::string(base)), body->link(std::string(end)));
    path.calcForwardKinematics(true, true);
    for (const auto& link : path) {
      const cnoid::Link* same = expected->link(link->name());
      const std::string where = link->name() + " from " + base + " to " + end;
      EXPECT_TRUE(link->T().isApprox(same->T(), 1e-14)) << where;
      EXPECT_TRUE(link->v().isApprox(same->v(), 1e-13)) << where;
      EXPECT_TRUE(link->w().isApprox(same->w(), 1e-13)) << where;
      EXPECT_TRUE(link->dv().isApprox(same->dv(), 1e-13)) << where;
      EXPECT_TRUE(link->dw().isApprox(same->dw(), 1e-13)) << where;
    }
  }
}

}  // namespace
