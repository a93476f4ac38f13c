#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/BasicSensors>
#include <cnoid/Body>
#include <cnoid/Camera>

#include "bodies.h"

namespace {

using cnoid::Body;
using cnoid::BodyPtr;
using cnoid::Device;
using cnoid::DevicePtr;
using cnoid::ForceSensor;
using cnoid::Imu;
using cnoid::Link;
using cnoid::LinkPtr;
using cnoid::Vector3;
using rehearse::test::make_arm;
using rehearse::test::make_link;
using testing::ElementsAre;

Device* add_device(Body& body, const std::string& link, Device* device, const std::string& name) {
  device->setName(name);
  EXPECT_TRUE(body.addDevice(device, body.link(link)));
  return device;
}

TEST(Body, StartsAsOneFreeLink) {
  const BodyPtr body = new Body("thing");
  EXPECT_EQ(body->name(), "thing");
  EXPECT_EQ(body->numLinks(), 1);
  EXPECT_TRUE(body->rootLink()->isFreeJoint());
  EXPECT_EQ(body->rootLink()->body(), body);
  EXPECT_EQ(body->numJoints(), 0);
}

TEST(Body, NumbersItsLinksDepthFirst) {
  const BodyPtr body = make_arm();
  std::vector<std::string> names;
  for (const auto& link : body->links()) names.push_back(link->name());
  EXPECT_THAT(names, ElementsAre("BASE", "ARM", "HAND", "TOOL"));
  EXPECT_EQ(body->link(2)->name(), "HAND");
  EXPECT_EQ(body->link(2)->index(), 2);
}

TEST(Body, AnswersAWrongNameOrNumberWithNull) {
  const BodyPtr body = make_arm();
  EXPECT_EQ(body->link("LEG"), nullptr);
  EXPECT_EQ(body->link(-1), nullptr);
  EXPECT_EQ(body->link(4), nullptr);
  EXPECT_EQ(body->joint("LEG"), nullptr);
  EXPECT_EQ(body->joint(-1), nullptr);
  EXPECT_EQ(body->joint(2), nullptr);
  EXPECT_EQ(body->device(0), nullptr);
  EXPECT_EQ(body->findDevice("camera"), nullptr);
}

TEST(Body, FindsAJointByItsIdItsNameAndItsLinksName) {
  const BodyPtr body = make_arm();
  EXPECT_EQ(body->numJoints(), 2);
  EXPECT_EQ(body->joint(0)->name(), "ARM");
  EXPECT_EQ(body->joint("SHOULDER")->name(), "ARM");
  EXPECT_EQ(body->joint("HAND")->name(), "HAND");
  EXPECT_EQ(body->link("SHOULDER"), nullptr);
}

TEST(Body, GivesItsJointsAsARangeOfLinks) {
  const BodyPtr body = make_arm();
  std::vector<std::string> names;
  for (auto joint : body->joints()) {
    Link* link = joint;
    names.push_back(link->name());
  }
  EXPECT_THAT(names, ElementsAre("ARM", "HAND"));
}

TEST(Body, FillsHolesAmongTheJointIdsWithDummies) {
  const BodyPtr body = make_arm();
  body->link("HAND")->setJointId(3);
  body->updateLinkTree();
  ASSERT_EQ(body->numJoints(), 4);
  const Link* dummy = body->joint(2);
  ASSERT_NE(dummy, nullptr);
  EXPECT_FALSE(dummy->isValid());
  EXPECT_TRUE(dummy->isFixedJoint());
  EXPECT_EQ(dummy->jointId(), 2);
  EXPECT_EQ(dummy->body(), nullptr);
  EXPECT_EQ(body->joint(3)->name(), "HAND");
}

TEST(Body, ListsMovingLinksWithoutAnIdAfterTheOthers) {
  const BodyPtr body = make_arm();
  body->link("ARM")->setJointId(-1);
  body->link("HAND")->setJointId(0);
  body->updateLinkTree();
  EXPECT_EQ(body->numJoints(), 1);
  EXPECT_EQ(body->numAllJoints(), 2);
  EXPECT_EQ(body->numVirtualJoints(), 1);
  EXPECT_EQ(body->allJoints()[1]->name(), "ARM");
  EXPECT_EQ(body->joint(1)->name(), "ARM");
}

TEST(Body, KeepsTheFirstOfTwoLinksWithOneJointId) {
  const BodyPtr body = make_arm();
  body->link("HAND")->setJointId(0);
  body->updateLinkTree();
  EXPECT_EQ(body->numJoints(), 1);
  EXPECT_EQ(body->joint(0)->name(), "ARM");
}

TEST(Body, FindsDevicesByTypeAndName) {
  const BodyPtr body = make_arm();
  Device* wrist = add_device(*body, "HAND", new ForceSensor, "wrist");
  Device* imu = add_device(*body, "BASE", new Imu, "imu");
  EXPECT_EQ(body->findDevice("wrist"), wrist);
  EXPECT_EQ(body->findDevice<ForceSensor>("wrist"), wrist);
  EXPECT_EQ(body->findDevice<Imu>("wrist"), nullptr);
  EXPECT_EQ(body->findDevice<Imu>(), imu);
  EXPECT_EQ(body->findDevice<cnoid::Camera>(), nullptr);
  EXPECT_EQ(body->findDevice<Imu>([](Imu* device) { return device->name() == "other"; }), nullptr);
  EXPECT_EQ(body->findDevices<ForceSensor>().size(), 1u);
  EXPECT_EQ(body->devices<ForceSensor>().size(), 1u);
  EXPECT_EQ(body->numDevices(), 2);
}

TEST(Body, NumbersDevicesAsTheyComeAndSortsThemByLink) {
  const BodyPtr body = make_arm();
  Device* wrist = add_device(*body, "HAND", new ForceSensor, "wrist");
  Device* imu = add_device(*body, "BASE", new Imu, "imu");
  EXPECT_EQ(wrist->index(), 0);
  EXPECT_EQ(imu->index(), 1);
  body->sortDevicesByLinkOrder();
  EXPECT_EQ(body->device(0), imu);
  EXPECT_EQ(wrist->index(), 1);
  EXPECT_EQ(wrist->link()->name(), "HAND");
  EXPECT_EQ(wrist->body(), body);
}

TEST(Body, RefusesADeviceForALinkOfAnotherBody) {
  const BodyPtr body = make_arm();
  const BodyPtr other = make_arm();
  const DevicePtr imu = new Imu;
  EXPECT_FALSE(body->addDevice(imu, other->rootLink()));
  EXPECT_FALSE(body->addDevice(imu, nullptr));
  EXPECT_EQ(body->numDevices(), 0);
}

TEST(Body, AddsADeviceOnlyOnce) {
  const BodyPtr body = make_arm();
  Device* imu = add_device(*body, "BASE", new Imu, "imu");
  EXPECT_TRUE(body->addDevice(imu, body->rootLink()));
  EXPECT_EQ(body->numDevices(), 1);
}

TEST(Body, LosesTheDevicesOfARemovedSubtree) {
  const BodyPtr body = make_arm();
  add_device(*body, "HAND", new ForceSensor, "wrist");
  Device* imu = add_device(*body, "BASE", new Imu, "imu");
  const LinkPtr arm = body->link("ARM");
  body->rootLink()->removeChild(arm);
  body->updateLinkTree();
  EXPECT_EQ(body->numDevices(), 1);
  EXPECT_EQ(body->device(0), imu);
  EXPECT_EQ(imu->index(), 0);
  EXPECT_EQ(body->numLinks(), 1);
  EXPECT_EQ(arm->body(), nullptr);
}

TEST(Body, LetsGoOfDevicesAndLinksThatOutliveIt) {
  BodyPtr body = make_arm();
  const DevicePtr imu = add_device(*body, "BASE", new Imu, "imu");
  const LinkPtr hand = body->link("HAND");
  body.reset();
  EXPECT_EQ(imu->link(), nullptr);
  EXPECT_EQ(imu->index(), -1);
  EXPECT_EQ(hand->body(), nullptr);
}

TEST(Body, ClonesStateTreeAndDevicesDeeply) {
  const BodyPtr body = make_arm();
  auto* wrist = static_cast<ForceSensor*>(add_device(*body, "HAND", new ForceSensor, "wrist"));
  wrist->F()[2] = 40.0;
  body->joint(0)->q() = 0.5;
  body->rootLink()->setTranslation(Vector3(1, 2, 3));
  body->setCache("kept", new Imu);

  const BodyPtr copy = body->clone();
  EXPECT_EQ(copy->name(), "arm");
  EXPECT_EQ(copy->modelName(), "ARM_MODEL");
  EXPECT_EQ(copy->numLinks(), 4);
  EXPECT_EQ(copy->joint(0)->q(), 0.5);
  EXPECT_EQ(copy->rootLink()->p(), Vector3(1, 2, 3));
  EXPECT_EQ(copy->link("TOOL")->parent(), copy->link("ARM"));
  auto* copied_wrist = copy->findDevice<ForceSensor>("wrist");
  ASSERT_NE(copied_wrist, nullptr);
  EXPECT_EQ(copied_wrist->F()[2], 40.0);
  EXPECT_EQ(copied_wrist->link(), copy->link("HAND"));
  EXPECT_EQ(copy->findCache<Imu>("kept"), nullptr);

  copy->joint(0)->q() = 1.0;
  copied_wrist->F()[2] = 0.0;
  EXPECT_EQ(body->joint(0)->q(), 0.5);
  EXPECT_EQ(wrist->F()[2], 40.0);
}

TEST(Body, MakesACachedObjectOnceForEachName) {
  const BodyPtr body = make_arm();
  EXPECT_EQ(body->findCache<Imu>("a"), nullptr);
  Imu* made = body->getOrCreateCache<Imu>("a");
  EXPECT_EQ(body->getOrCreateCache<Imu>("a"), made);
  EXPECT_NE(body->getOrCreateCache<Imu>("b"), made);
  EXPECT_EQ(body->findCache<ForceSensor>("a"), nullptr);
  body->removeCache("a");
  EXPECT_EQ(body->findCache<Imu>("a"), nullptr);
}

TEST(Body, KnowsWhetherAnythingInItMoves) {
  const BodyPtr body = make_arm();
  EXPECT_FALSE(body->isFixedRootModel());
  body->setRootLinkFixed(true);
  EXPECT_TRUE(body->isFixedRootModel());
  EXPECT_FALSE(body->isStaticModel());
  EXPECT_TRUE(body->hasMovableJoints());
  body->link("ARM")->setJointType(Link::FixedJoint);
  body->link("HAND")->setJointType(Link::FixedJoint);
  EXPECT_TRUE(body->isStaticModel());
}

TEST(Body, AddsUpMassAndFindsItsCentre) {
  const BodyPtr body = make_arm();
  for (const auto& link : body->links()) link->setMass(0.0);
  body->link("BASE")->setMass(1.0);
  body->link("HAND")->setMass(3.0);
  body->link("HAND")->setCenterOfMass(Vector3(0, 0, 1));
  body->calcForwardKinematics();
  EXPECT_EQ(body->mass(), 4.0);
  // HAND stands at (2, 0, 1), its centre of mass 1 m above
  EXPECT_TRUE(body->calcCenterOfMass().isApprox(Vector3(1.5, 0, 1.5)));
  EXPECT_EQ(body->link("HAND")->wc(), Vector3(2, 0, 2));
}

TEST(Body, AddsUpMomentum) {
  const BodyPtr body = new Body("top");
  Link* root = body->rootLink();
  root->setMass(2.0);
  root->setInertia(Vector3(1, 2, 3).asDiagonal());
  root->setTranslation(Vector3(0, 1, 0));
  root->v() = Vector3(5, 0, 0);
  root->w() = Vector3(0, 0, 4);
  body->calcCenterOfMass();
  Vector3 P, L;
  body->calcTotalMomentum(P, L);
  EXPECT_EQ(P, Vector3(10, 0, 0));
  EXPECT_EQ(L, Vector3(0, 0, 12 - 10));  // I w, and r x P = (0,1,0) x (10,0,0)
}

TEST(Body, InitializesToItsModelsPosition) {
  const BodyPtr body = make_arm();
  auto* imu = static_cast<Imu*>(add_device(*body, "BASE", new Imu, "imu"));
  imu->w() = Vector3::Ones();
  cnoid::Isometry3 start = cnoid::Isometry3::Identity();
  start.translation() = Vector3(0, 0, 5);
  body->resetDefaultPosition(start);
  body->joint(1)->setInitialJointDisplacement(0.5);
  body->joint(1)->dq() = 3.0;
  body->initializePosition();
  EXPECT_EQ(body->joint(1)->q(), 0.5);
  EXPECT_EQ(body->joint(1)->q_target(), 0.5);
  EXPECT_EQ(body->joint(1)->dq(), 0.0);
  EXPECT_TRUE(body->link("HAND")->p().isApprox(Vector3(2.5, 0, 6)));
  EXPECT_TRUE(imu->w().isZero(0.0));
}

TEST(Body, ClearsTheExternalForcesOfAllLinks) {
  const BodyPtr body = make_arm();
  body->link("HAND")->F_ext().setOnes();
  body->clearExternalForces();
  EXPECT_TRUE(body->link("HAND")->F_ext().isZero(0.0));
}

TEST(Body, AsksItsClockForTheTime) {
  const BodyPtr body = make_arm();
  EXPECT_EQ(body->currentTime(), 0.0);
  body->setCurrentTimeFunction([] { return 1.25; });
  EXPECT_EQ(body->currentTime(), 1.25);
}

TEST(Body, BecomesACopyOfAnother) {
  const BodyPtr original = rehearse::test::make_biped();
  original->setModelName("WALKER");
  const cnoid::ExtraJointPtr rod = new cnoid::ExtraJoint(cnoid::ExtraJoint::Piston, cnoid::Vector3(0, 0, 2));
  rod->setLink(0, original->link("LEFT1"));
  rod->setLink(1, original->link("HEAD"));
  rod->setPoint(1, cnoid::Vector3(1, 2, 3));
  original->addExtraJoint(rod);
  const BodyPtr body = rehearse::test::make_arm();
  body->copyFrom(original);
  EXPECT_EQ(body->name(), "biped");
  EXPECT_EQ(body->modelName(), "WALKER");
  EXPECT_EQ(body->numJoints(), 14);
  EXPECT_EQ(body->link("ARM"), nullptr);
  EXPECT_NE(body->link("HEAD"), original->link("HEAD"));
  EXPECT_TRUE(body->info()->findListing("foot_links")->isValid());
  ASSERT_EQ(body->numExtraJoints(), 1);
  const cnoid::ExtraJoint& copy = *body->extraJoint(0);
  EXPECT_NE(&copy, rod.get());
  EXPECT_EQ(copy.type(), cnoid::ExtraJoint::Piston);
  EXPECT_EQ(copy.axis(), cnoid::Vector3::UnitZ());
  EXPECT_EQ(copy.link(0), body->link("LEFT1"));
  EXPECT_EQ(copy.linkName(1), "HEAD");
  EXPECT_EQ(copy.bodyName(1), "biped");
  EXPECT_EQ(cnoid::Vector3(copy.point(1)), cnoid::Vector3(1, 2, 3));
  EXPECT_TRUE(copy.isForLinksOfSameBody());
  EXPECT_EQ(body->extraJoint(1), nullptr);
  body->copyFrom(body);
  EXPECT_EQ(body->numExtraJoints(), 1);
  body->setRootLink(body->createLink(original->link("HEAD")));
  EXPECT_EQ(body->numExtraJoints(), 0);
}

TEST(Body, CreatesLinksThatBelongToNoBody) {
  const BodyPtr body = rehearse::test::make_biped();
  const cnoid::LinkPtr fresh = body->createLink();
  EXPECT_EQ(fresh->body(), nullptr);
  EXPECT_EQ(fresh->jointType(), cnoid::Link::FixedJoint);
  const cnoid::LinkPtr copy = body->createLink(body->link("CHEST"));
  EXPECT_EQ(copy->name(), "CHEST");
  EXPECT_EQ(copy->child(), nullptr);
  EXPECT_EQ(copy->m(), body->link("CHEST")->m());
}

}  // namespace
