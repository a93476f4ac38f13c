#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/BodyMotion>
#include <cnoid/YAMLReader>
#include <cnoid/ZMPSeq>

#include <sstream>
#include <stdexcept>
#include <string>

#include "bodies.h"
#include "support/printed_by_name.h"

namespace {

using cnoid::BodyMotion;
using cnoid::BodyPtr;
using cnoid::Vector3;
using testing::StartsWith;

std::string motion_path(const std::string& name) { return FIXTURES_DIR "/motions/" + name + ".seq"; }

std::string table(const cnoid::MultiValueSeq& seq) {
  std::ostringstream text;
  for (int i = 0; i < seq.numFrames(); ++i) {
    for (const double value : seq.frame(i)) text << value << " ";
    text << "| ";
  }
  return text.str();
}

TEST(BodyMotion, ReadsTheFirstVersionUnderItsOwnNames) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version1"))) << motion.seqMessage();
  EXPECT_EQ(motion.frameRate(), 100.0);
  EXPECT_EQ(table(*motion.jointPosSeq()), "0 1 | 2 3 | ");
  const cnoid::SE3 pose = motion.linkPosSeq()->frame(1)[0];
  EXPECT_EQ(pose.translation(), Vector3(4, 5, 6));
  EXPECT_EQ(pose.rotation().z(), 1.0);
  EXPECT_EQ(pose.rotation().w(), 0.0);
  ASSERT_NE(getZMPSeq(motion), nullptr);
  EXPECT_TRUE(getZMPSeq(motion)->isRootRelative());
  EXPECT_EQ(getZMPSeq(motion)->frame(1), Vector3(0.3, 0.4, 0));
}

TEST(BodyMotion, ReadsTheSecondVersionWithWhatItsPartsInherit) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version2"))) << motion.seqMessage();
  EXPECT_EQ(motion.seqMessage(), "");
  EXPECT_EQ(motion.numFrames(), 3);
  EXPECT_EQ(motion.numJoints(), 2);
  EXPECT_EQ(motion.numLinks(), 1);
  EXPECT_EQ(motion.timeStep(), 0.002);
  motion.updateJointPosSeqWithBodyStateSeq();
  const auto joints = motion.jointPosSeq();
  EXPECT_EQ(table(*joints), "0 -0.036 | 1.75e-08 -0.035 | 0.5 0.25 | ");
  EXPECT_EQ(joints->timeStep(), 0.002);
  EXPECT_EQ(joints->seqContentName(), "JointDisplacement");
  const cnoid::AngleAxis turn(motion.linkPosSeq()->frame(2)[0].rotation());
  EXPECT_NEAR(turn.angle() * turn.axis().z(), 1.0, 1e-15);
  EXPECT_TRUE(getZMPSeq(motion)->isRootRelative());
  EXPECT_EQ(table(*motion.extraSeq<cnoid::MultiValueSeq>("Torque")), "1 | 2 | 3 | ");
}

TEST(BodyMotion, ReadsTheThirdVersionUnderItsOwnNames) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version3"))) << motion.seqMessage();
  EXPECT_EQ(table(*motion.jointPosSeq()), "0.5 | 0.75 | ");
  EXPECT_EQ(motion.linkPosSeq()->frame(1)[0].translation().z(), 2.0);
  EXPECT_EQ(getZMPSeq(motion)->frame(1), Vector3(4, 5, 6));
  EXPECT_FALSE(getZMPSeq(motion)->isRootRelative());
}

TEST(BodyMotion, ReadsTheFourthVersionAndFillsTheGapsBetweenFramesWithTimes) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version4"))) << motion.seqMessage();
  EXPECT_EQ(table(*motion.jointPosSeq()), "0.5 | 0.5 | 1.5 | 2.5 | ");
  EXPECT_EQ(motion.numLinks(), 0);
}

TEST(BodyMotion, PassesOverAComponentThatItDoesNotKnowAndSaysSo) {
  std::ostringstream text;
  cnoid::YAMLReader reader;
  ASSERT_TRUE(
      reader.parse("type: CompositeSeq\nformatVersion: 2\nframeRate: 100\ncomponents:\n"
                   "  - { type: MultiValueSeq, content: JointDisplacement, numParts: 1, frames: [ [ 7 ] ] }\n"
                   "  - { type: SongSeq }\n"));
  BodyMotion motion;
  EXPECT_TRUE(motion.readSeq(reader.document()->toMapping(), text));
  EXPECT_EQ(text.str(), "line 6:13: warning: a component of the unknown type SongSeq is passed over\n");
  EXPECT_EQ(motion.seqMessage(), text.str());
  EXPECT_EQ(table(*motion.jointPosSeq()), "7 | ");
}

struct Mistake {
  std::string file;
  std::string message;  // after "file:"
};

class BrokenMotion : public testing::TestWithParam<Mistake> {};

TEST_P(BrokenMotion, IsRefusedWithItsPlace) {
  const std::string path = FIXTURES_DIR "/broken/seq_" + GetParam().file + ".seq";
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version2")));
  std::ostringstream text;
  EXPECT_FALSE(motion.load(path, text));
  EXPECT_THAT(text.str(), StartsWith(path + ":" + GetParam().message));
  EXPECT_EQ(text.str().back(), '\n');
  EXPECT_EQ(motion.seqMessage(), text.str());
  EXPECT_EQ(motion.numFrames(), 0) << "nothing of the motion before it may remain";
  EXPECT_FALSE(motion.hasExtraSeqs());
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenMotion,
    testing::Values(Mistake{"without_frames", "6:5: error: the key \"frames\" is missing"},
                    Mistake{"no_frame", "6:77: error: \"frames\" holds no frame"},
                    Mistake{"short_frame", "11:9: error: a frame of 1 elements stands where frames have 2"},
                    Mistake{"number_of_text", "6:84: error: \"left\" is no number"},
                    Mistake{"no_parts", "6:66: error: \"numParts\" must be 1 or more"},
                    Mistake{"frames_of_text", "6:77: error: a list is expected here, not a single value"},
                    Mistake{"only_zmp", "6:3: error: the motion holds neither joint displacements nor link positions"},
                    Mistake{"unlike_numbers_of_frames",
                            "6:3: error: the motion has 2 frames of joint displacements and 1 of link positions"},
                    Mistake{"unknown_pose_format", "6:73: error: poses can't be written as \"RPYXYZ\""},
                    Mistake{"short_pose", "6:93: error: a pose of 3 numbers stands where poses have 6"},
                    Mistake{"component_without_type", "6:5: error: the key \"type\" is missing"},
                    Mistake{"frame_before_the_first", "6:101: error: a frame can't have the time -0.5"},
                    Mistake{"frame_of_next_year", "6:101: error: a frame can't have the time 3.2e+07"},
                    Mistake{"another_version",
                            "3:16: error: motions of format version 5 can't be read (versions 1 to 4 can)"},
                    Mistake{"version_of_text", "2:16: error: \"two\" is no number"},
                    Mistake{"another_type", "1:7: error: a MultiValueSeq stands where a CompositeSeq is expected"},
                    Mistake{"without_rate", "4:5: error: the key \"frameRate\" is missing"},
                    Mistake{"rate_zero", "3:12: error: a frame rate must be a number above 0"},
                    Mistake{"without_components", "1:1: error: the key \"components\" is missing"},
                    Mistake{"no_yaml", "3:1: error: "},
                    Mistake{"a_list", "1:1: error: a mapping is expected here, not a list"},
                    Mistake{"empty", " error: the file is empty"},
                    Mistake{"first_version_with_times", "3:80: error: frames have no times in format version 1"},
                    Mistake{"that_is_not_there", " error: the file can't be read"}),
    [](const auto& test) { return test.param.file; });

TEST(BodyMotion, KeepsTheMotionOfABody) {
  const BodyPtr body = rehearse::test::make_arm();
  BodyMotion motion;
  motion.setFrameRate(100.0);
  for (int i = 0; i < 3; ++i) {
    body->joint(0)->q() = 0.5 * i;
    body->calcForwardKinematics();
    motion.frame(i) << *body;
  }
  EXPECT_EQ(motion.numFrames(), 3);
  const BodyPtr other = rehearse::test::make_arm();
  motion.frame(1) >> *other;
  EXPECT_EQ(other->joint(0)->q(), 0.5);
  const BodyMotion& constant = motion;
  *other << constant.frame(2);
  EXPECT_EQ(other->joint(0)->q(), 1.0);
  EXPECT_TRUE(other->link("HAND")->T().isApprox(body->link("HAND")->T(), 1e-15));
}

TEST(BodyMotion, TurnsItsTablesIntoStatesAndBack) {
  BodyMotion motion;
  motion.setDimension(2, 2, 1);
  motion.setFrameRate(50.0);
  motion.jointPosSeq()->frame(1)[1] = 0.5;
  motion.linkPosSeq()->frame(1)[0].translation() = Vector3(1, 2, 3);
  motion.updateBodyStateSeqWithLinkPosSeqAndJointPosSeq();
  EXPECT_EQ(motion.stateSeq()->frame(1).jointDisplacement(1), 0.5);
  EXPECT_EQ(Vector3(motion.stateSeq()->frame(1).linkPosition(0).translation()), Vector3(1, 2, 3));
  motion.stateSeq()->frame(0).jointDisplacement(0) = 0.25;
  motion.updateLinkPosSeqAndJointPosSeqWithBodyStateSeq();
  EXPECT_EQ(table(*motion.jointPosSeq()), "0.25 0 | 0 0.5 | ");
  motion.jointPosSeq()->setNumFrames(5);
  EXPECT_THROW(motion.updateBodyStateSeqWithLinkPosSeqAndJointPosSeq(), std::logic_error);
}

TEST(BodyMotion, CopiesAllThatComesAlong) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version2")));
  BodyMotion copy(motion);
  BodyMotion assigned;
  int changes = 0;
  assigned.sigExtraSeqsChanged().connect([&] { ++changes; });
  assigned = motion;
  EXPECT_EQ(changes, 1);
  getZMPSeq(motion)->frame(0) = Vector3(9, 9, 9);
  motion.stateSeq()->frame(0).jointDisplacement(0) = 9.0;
  EXPECT_EQ(getZMPSeq(copy)->frame(0), Vector3(0, 0, 0));
  EXPECT_EQ(getZMPSeq(assigned)->frame(0), Vector3(0, 0, 0));
  EXPECT_EQ(copy.stateSeq()->frame(0).jointDisplacement(0), 0.0);
  EXPECT_EQ(assigned.frameRate(), 500.0);
}

TEST(BodyMotion, KeepsAllThatComesAlongInStep) {
  BodyMotion motion;
  ASSERT_TRUE(motion.load(motion_path("version2")));
  motion.setFrameRate(250.0);
  motion.setOffsetTime(1.0);
  motion.setNumFrames(5, true);
  EXPECT_EQ(getZMPSeq(motion)->frameRate(), 250.0);
  EXPECT_EQ(getZMPSeq(motion)->offsetTime(), 1.0);
  EXPECT_EQ(getZMPSeq(motion)->frame(4), Vector3(0, 0.2, 0));
  EXPECT_EQ(motion.stateSeq()->frame(4).jointDisplacement(0), 0.5);
  clearZMPSeq(motion);
  EXPECT_EQ(getZMPSeq(motion), nullptr);
  EXPECT_EQ(getOrCreateZMPSeq(motion)->numFrames(), 5);
  motion.clearExtraSeqs();
  EXPECT_FALSE(motion.hasExtraSeqs());
}

}  // namespace
