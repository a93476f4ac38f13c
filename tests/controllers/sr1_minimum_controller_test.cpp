#include <gtest/gtest.h>

#include "bodies.h"
#include "controller_library.h"
#include "test_io.h"

namespace {

using cnoid::Body;
using cnoid::BodyPtr;
using cnoid::Link;
using rehearse::test::ControllerLibrary;
using rehearse::test::make_link;
using rehearse::test::TestIO;

BodyPtr make_chain(int joints) {
  Link* root = make_link("ROOT", Link::FreeJoint);
  Link* last = root;
  for (int id = 0; id < joints; ++id) {
    Link* link = make_link("J" + std::to_string(id), Link::RevoluteJoint, id);
    last->appendChild(link);
    last = link;
  }
  BodyPtr body = new Body("chain");
  body->setRootLink(root);
  return body;
}

TEST(SR1MinimumController, EnablesTorqueOnAll29Joints) {
  const BodyPtr body = make_chain(29);
  TestIO io(body);
  ControllerLibrary library(SR1_MINIMUM_CONTROLLER);
  ASSERT_TRUE(library.controller()->initialize(&io));
  EXPECT_EQ(io.outputs.size(), 29u);
  EXPECT_EQ(io.inputs.size(), 29u);
  EXPECT_EQ(body->joint(28)->actuationMode(), Link::JointTorque);
}

TEST(SR1MinimumController, PullsBackToWhereItStartedBitForBit) {
  const BodyPtr body = make_chain(29);
  for (Link* joint : body->joints()) joint->q() = 0.1 * joint->jointId();
  TestIO io(body);
  ControllerLibrary library(SR1_MINIMUM_CONTROLLER);
  ASSERT_TRUE(library.controller()->initialize(&io));
  std::vector<double> q_before;
  for (Link* joint : body->joints()) q_before.push_back(joint->q());
  const std::vector<double> q_reference = q_before;
  for (int step = 1; step <= 3; ++step) {
    for (Link* joint : body->joints()) joint->q() += 0.0001 * step * (joint->jointId() - 14);
    EXPECT_TRUE(library.controller()->control());
    for (Link* joint : body->joints()) {
      const auto i = static_cast<std::size_t>(joint->jointId());
      const double p_gain = (i >= 6 && i < 13) || (i >= 19 && i < 26) ? 3000.0 : 8000.0;  // arms, then the rest
      const double q = joint->q();
      const double dq = (q - q_before[i]) / 0.001;
      EXPECT_EQ(joint->u(), (q_reference[i] - q) * p_gain - dq * 100.0) << "joint " << i << ", step " << step;
      q_before[i] = q;
    }
  }
}

TEST(SR1MinimumController, RefusesARobotForWhichItHasNoGains) {
  TestIO io(make_chain(30));
  ControllerLibrary library(SR1_MINIMUM_CONTROLLER);
  EXPECT_FALSE(library.controller()->initialize(&io));
  EXPECT_NE(io.messages.str().find("has 30 joints, but there are gains for 29 only"), std::string::npos);
}

}  // namespace
