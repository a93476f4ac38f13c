#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/SimpleController>

#include <stdexcept>

#include "bodies.h"
#include "test_io.h"

namespace {

using cnoid::BodyPtr;
using cnoid::Link;
using cnoid::SimpleController;
using cnoid::SimpleControllerConfig;
using cnoid::SimpleControllerIO;
using rehearse::test::make_arm;
using rehearse::test::TestIO;
using testing::ElementsAre;
using testing::Pair;

TEST(SimpleController, AgreesToEverythingButControlByDefault) {
  struct Idle : SimpleController {
  } controller;
  EXPECT_TRUE(controller.configure(nullptr));
  EXPECT_TRUE(controller.initialize(nullptr));
  EXPECT_TRUE(controller.start());
  EXPECT_FALSE(controller.control());
  EXPECT_TRUE(controller.resume());
  controller.pause();
  controller.stop();
  controller.unconfigure();
}

TEST(SimpleControllerIO, EnablesAllJointsByTheOldFunctions) {
  TestIO io(make_arm());
  io.setJointInput(Link::JointAngle | Link::JointVelocity);
  io.setJointOutput(SimpleControllerIO::JOINT_TORQUE);
  EXPECT_THAT(io.inputs, ElementsAre(Pair("ARM", 3), Pair("HAND", 3)));
  EXPECT_THAT(io.outputs, ElementsAre("ARM", "HAND"));
  EXPECT_EQ(io.body()->joint(0)->actuationMode(), Link::JointTorque);
}

TEST(SimpleControllerIO, LeavesDummyJointsAlone) {
  const BodyPtr body = make_arm();
  body->link("HAND")->setJointId(2);
  body->updateLinkTree();
  TestIO io(body);
  io.setJointInput(Link::JointAngle);
  io.setJointOutput(Link::JointTorque);
  EXPECT_THAT(io.inputs, ElementsAre(Pair("ARM", 1), Pair("HAND", 1)));
  EXPECT_EQ(io.body()->joint(1)->actuationMode(), Link::StateNone);
}

TEST(SimpleControllerIO, EnablesOneLinkByTheOldFunctions) {
  TestIO io(make_arm());
  Link* base = io.body()->rootLink();
  io.setLinkInput(base, Link::LinkPosition);
  io.setLinkOutput(base, Link::LinkPosition);
  EXPECT_THAT(io.inputs, ElementsAre(Pair("BASE", 16)));
  EXPECT_THAT(io.outputs, ElementsAre("BASE"));
  EXPECT_THROW(io.setLinkInput(nullptr, Link::LinkPosition), std::invalid_argument);
}

TEST(SimpleControllerIO, HasItsNameUnderTheOldNameToo) {
  const TestIO io(make_arm());
  EXPECT_EQ(io.name(), io.controllerName());
}

TEST(SimpleControllerIO, SharesObjectsByName) {
  struct Shared : cnoid::Referenced {
    int value = 0;
  };
  const BodyPtr body = make_arm();
  TestIO parent(body);
  TestIO child(body);
  EXPECT_EQ(parent.findSharedObject<Shared>("plan"), nullptr);
  parent.getOrCreateSharedObject<Shared>("plan")->value = 5;
  EXPECT_EQ(child.getOrCreateSharedObject<Shared>("plan")->value, 5);
}

TEST(SimulationSimpleControllerIO, HasNoDelayModeUnderItsOldName) {
  TestIO io(make_arm());
  SimpleControllerIO* plain = &io;
  auto* simulation = dynamic_cast<cnoid::SimulationSimpleControllerIO*>(plain);
  ASSERT_NE(simulation, nullptr);
  simulation->setImmediateMode(true);
  EXPECT_TRUE(io.isNoDelayMode());
  EXPECT_TRUE(simulation->isImmediateMode());
}

TEST(SimpleControllerConfig, AnswersFromItsIO) {
  TestIO io(make_arm());
  io.options_text = "a b";
  SimpleControllerConfig config(&io);
  EXPECT_EQ(config.controllerName(), "tested");
  EXPECT_EQ(config.body(), io.body());
  EXPECT_EQ(config.optionString(), "a b");
  EXPECT_THAT(config.options(), ElementsAre("a", "b"));
  config.os() << "hello";
  EXPECT_EQ(io.messages.str(), "hello");
  EXPECT_EQ(config.bodyItem(), nullptr);
  EXPECT_TRUE(config.sigChanged().connect([] {}).connected());
}

}  // namespace
