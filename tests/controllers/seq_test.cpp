#include <gtest/gtest.h>
#include <cnoid/BodyStateSeq>
#include <cnoid/MultiSE3Seq>
#include <cnoid/MultiValueSeq>
#include <cnoid/Vector3Seq>

#include <memory>
#include <stdexcept>
#include <type_traits>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::BodyState;
using cnoid::MultiSE3Seq;
using cnoid::MultiValueSeq;
using cnoid::Vector3;
using cnoid::Vector3Seq;

static_assert(std::is_same_v<cnoid::MultiValueSeqPtr, std::shared_ptr<MultiValueSeq>>);

/// Three frames of two parts: 0 1, 10 11, 20 21, at 100 Hz.
MultiValueSeq make_seq() {
  MultiValueSeq seq(3, 2);
  seq.setFrameRate(100.0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) seq.frame(i)[j] = 10 * i + j;
  }
  return seq;
}

TEST(MultiValueSeq, HasFramesOfParts) {
  MultiValueSeq seq = make_seq();
  EXPECT_EQ(seq.numFrames(), 3);
  EXPECT_EQ(seq.numParts(), 2);
  EXPECT_EQ(seq.timeStep(), 0.01);
  MultiValueSeq::Frame frame = seq.frame(1);
  EXPECT_EQ(frame.size(), 2);
  EXPECT_EQ(frame[1], 11.0);
  frame = seq.frame(2);
  EXPECT_EQ(frame.at(0), 20.0);
  EXPECT_THROW(frame.at(2), std::out_of_range);
  EXPECT_EQ(seq.part(1)[2], 21.0);
  EXPECT_TRUE(MultiValueSeq::Frame().empty());
}

TEST(MultiValueSeq, ClampsFramesToThoseThatThereAre) {
  const MultiValueSeq seq = make_seq();
  EXPECT_EQ(seq.clampedFrame(-5)[0], 0.0);
  EXPECT_EQ(seq.clampedFrame(99)[0], 20.0);
  bool is_within = true;
  EXPECT_EQ(seq.clampedFrame(3, is_within)[0], 20.0);
  EXPECT_FALSE(is_within);
  EXPECT_EQ(seq.clampedFrame(2, is_within)[0], 20.0);
  EXPECT_TRUE(is_within);
}

TEST(MultiValueSeq, RefusesFramesThatAreNotThere) {
  const MultiValueSeq seq = make_seq();
  EXPECT_THROW(seq.frame(3), std::out_of_range);
  EXPECT_THROW(seq.frame(-1), std::out_of_range);
  EXPECT_THROW(MultiValueSeq().clampedFrame(0), std::out_of_range);
  EXPECT_THROW(seq.part(2), std::out_of_range);
}

TEST(MultiValueSeq, GrowsByZerosOrByItsLastFrame) {
  MultiValueSeq seq = make_seq();
  seq.setNumFrames(4);
  EXPECT_EQ(seq.frame(3)[1], 0.0);
  seq.setNumFrames(3);
  seq.setNumFrames(5, true);
  EXPECT_EQ(seq.frame(4)[1], 21.0);
  EXPECT_EQ(seq.frame(0)[1], 1.0);
  seq.setNumParts(3);
  EXPECT_EQ(seq.frame(0)[1], 0.0) << "with other parts the old values mean nothing";
}

TEST(MultiValueSeq, TakesFramesBehindAndGivesThemUpInFront) {
  MultiValueSeq seq = make_seq();
  seq.appendFrame()[0] = 30.0;
  EXPECT_EQ(seq.numFrames(), 4);
  EXPECT_EQ(seq.lastFrame()[0], 30.0);
  seq.popFrontFrames(2);
  EXPECT_EQ(seq.frame(0)[0], 20.0);
  seq.popFrontFrames(9);
  EXPECT_EQ(seq.numFrames(), 0);
}

TEST(MultiValueSeq, KnowsTimes) {
  MultiValueSeq seq = make_seq();
  seq.setOffsetTime(1.0);
  EXPECT_DOUBLE_EQ(seq.timeOfFrame(2), 1.02);
  EXPECT_EQ(seq.frameOfTime(1.025), 2);
  EXPECT_DOUBLE_EQ(seq.timeLength(), 0.03);
  seq.setTimeStep(0.5);
  EXPECT_EQ(seq.frameRate(), 2.0);
  seq.setFrameRate(0.0);
  EXPECT_EQ(seq.timeStep(), 0.0);
}

TEST(MultiValueSeq, ClonesIntoOneOfItsOwn) {
  MultiValueSeq seq = make_seq();
  seq.setSeqContentName("JointDisplacement");
  const auto copy = std::dynamic_pointer_cast<MultiValueSeq>(seq.cloneSeq());
  seq.frame(0)[0] = 5.0;
  EXPECT_EQ(copy->frame(0)[0], 0.0);
  EXPECT_EQ(copy->seqContentName(), "JointDisplacement");
  EXPECT_EQ(copy->frameRate(), 100.0);
}

TEST(MultiSE3Seq, BeginsAtTheOrigin) {
  MultiSE3Seq seq(1, 2);
  seq.setNumFrames(2);
  EXPECT_EQ(seq.frame(0)[1].translation(), Vector3(0, 0, 0));
  EXPECT_EQ(seq.frame(1)[0].rotation().w(), 1.0);
}

TEST(Vector3Seq, HasAVectorAFrame) {
  Vector3Seq seq(1);
  EXPECT_EQ(seq[0], Vector3(0, 0, 0));
  seq.append(Vector3(1, 2, 3));
  seq.setNumFrames(3, true);
  EXPECT_EQ(seq.back(), Vector3(1, 2, 3));
  EXPECT_EQ(seq.clampFrameIndex(9), 2);
  EXPECT_THROW(seq.at(3), std::out_of_range);
  seq.popFront();
  EXPECT_EQ(seq.front(), Vector3(1, 2, 3));
  seq.popBack();
  EXPECT_EQ(seq.numFrames(), 1);
  EXPECT_EQ(seq.frameRate(), 100.0);
}

TEST(BodyState, GivesABodyBackWhatItHad) {
  const BodyPtr body = rehearse::test::make_arm();
  body->joint(0)->q() = 0.5;
  body->rootLink()->setTranslation(Vector3(1, 2, 3));
  body->calcForwardKinematics();
  const BodyState state(body);
  EXPECT_EQ(state.numLinkPositions(), 4);
  EXPECT_EQ(state.numJointDisplacements(), 2);
  EXPECT_EQ(state.jointDisplacement(0), 0.5);

  const BodyPtr other = rehearse::test::make_arm();
  EXPECT_TRUE(state.restoreStateToBody(other));
  EXPECT_EQ(other->joint(0)->q(), 0.5);
  EXPECT_TRUE(other->link("HAND")->T().isApprox(body->link("HAND")->T(), 1e-15));
  EXPECT_FALSE(BodyState().restoreStateToBody(other));
}

TEST(BodyState, MovesTheWholeBodyWithItsRootAlone) {
  BodyState state;
  state.allocate(1, 1);
  state.rootLinkPosition().set(Vector3(0, 0, 5), cnoid::Quaternion::Identity());
  state.jointDisplacement(0) = 0.0;
  const BodyPtr body = rehearse::test::make_arm();
  *body << state;
  EXPECT_EQ(body->link("ARM")->p().z(), 6.0);
}

TEST(BodyStateSeq, AllocatesFramesAsItIsTold) {
  cnoid::BodyStateSeq seq;
  seq.setNumLinkPositionsHint(1);
  seq.setNumJointDisplacementsHint(2);
  seq.allocateFrame(3).jointDisplacement(1) = 0.5;
  EXPECT_EQ(seq.numFrames(), 4);
  EXPECT_TRUE(seq.frame(2).empty());
  EXPECT_EQ(seq.frame(3).numLinkPositions(), 1);
  EXPECT_EQ(seq.appendAllocatedFrame().numJointDisplacements(), 2);
}

}  // namespace
