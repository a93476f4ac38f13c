// The tool that makes fixtures/motions/sr1_walk.seq.
#include "make_walk/walking_pattern.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/urdf.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace rehearse::tool {
namespace {

using ::testing::HasSubstr;

const Model& sr1() {
  static const auto model = load_urdf(FIXTURES_DIR "/models/sr1.urdf");
  return model.value();
}

std::string mistake(const Model& model, const WalkParameters& parameters) {
  const auto pattern = walking_pattern(model, parameters);
  return pattern ? "none" : to_string(pattern.errors());
}

/// From the right ankle to the left one, in the waist's frame [m].
Eigen::Vector3d between_ankles(const std::vector<double>& frame) {
  const auto links = forward_kinematics(sr1(), Eigen::Isometry3d::Identity(), frame);
  const auto place = [&](const char* name) {
    return links[static_cast<std::size_t>(sr1().find_link(name))].translation();
  };
  return place("LLEG_ANKLE_R") - place("RLEG_ANKLE_R");
}

#ifndef __SANITIZE_ADDRESS__  // most of a minute each, of the same function as for the fewer steps below
TEST(WalkingPattern, IsTheMotionOfTheSample) {
  const auto pattern = walking_pattern(sr1(), {});
  ASSERT_TRUE(pattern) << to_string(pattern.errors());
  const std::string committed = test::read_file(FIXTURES_DIR "/motions/sr1_walk.seq");
  EXPECT_TRUE(motion_text(*pattern, {}) == committed) << "build/bin/make_walk makes the file again";
}

TEST(WalkingPattern, HasTheWantedZmpForTheWholeBody) {
  WalkParameters parameters;
  parameters.steps = 3;
  for (const double length : {0.05, 0.3}) {
    parameters.step_length = length;
    const auto pattern = walking_pattern(sr1(), parameters);
    ASSERT_TRUE(pattern) << to_string(pattern.errors());
    EXPECT_LT(pattern->zmp_error, 0.002) << length << " m";  // [m]
  }
}
#endif

TEST(WalkingPattern, PutsAFootOneStepAheadOfTheOther) {
  WalkParameters parameters;
  parameters.steps = 3;
  const auto pattern = walking_pattern(sr1(), parameters);
  ASSERT_TRUE(pattern) << to_string(pattern.errors());
  for (int step = 0; step <= parameters.steps; ++step) {
    const double time = parameters.pause + step * parameters.step_time;
    const auto frame = static_cast<std::size_t>(std::lround(time * parameters.frame_rate));
    const double ahead = step == 0 || step == parameters.steps ? 0.0 : step % 2 == 1 ? 0.2 : -0.2;  // [m]
    EXPECT_NEAR(between_ankles(pattern->frames[frame]).x(), ahead, 1e-9) << "when step " << step << " begins";
    EXPECT_NEAR(between_ankles(pattern->frames[frame]).y(), 0.18, 1e-9);
    EXPECT_NEAR(between_ankles(pattern->frames[frame]).z(), 0.0, 1e-9);
  }
  EXPECT_DOUBLE_EQ(pattern->distance, 0.4);
}

TEST(WalkingPattern, LiftsTheSwingingFoot) {
  WalkParameters parameters;
  parameters.steps = 3;
  const auto pattern = walking_pattern(sr1(), parameters);
  ASSERT_TRUE(pattern) << to_string(pattern.errors());
  double left = 0.0, right = 0.0;
  for (const auto& frame : pattern->frames) {
    left = std::max(left, between_ankles(frame).z());
    right = std::min(right, between_ankles(frame).z());
  }
  EXPECT_NEAR(left, 0.06, 0.002);  // [m]; the highest moment is between two frames
  EXPECT_NEAR(right, -0.06, 0.002);
}

TEST(WalkingPattern, RefusesWhatALegCantDo) {
  WalkParameters parameters;
  parameters.step_length = 0.8;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("a foot is out of reach at "));
  parameters = {};
  parameters.waist_height = 0.3;
  parameters.lift = 0.2;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("LLEG_KNEE is 2.6"));
}

TEST(WalkingPattern, RefusesParametersWithoutMeaning) {
  WalkParameters parameters;
  parameters.steps = 0;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("steps is 0 (at least 1)"));
  parameters = {};
  parameters.double_support = 0.8;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("a step takes 0.8 s, of which 0.8 s on both feet"));
  parameters = {};
  parameters.frame_rate = 0.0;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("frame rate 0"));
  parameters = {};
  parameters.pause = 1000.0;
  EXPECT_THAT(mistake(sr1(), parameters), HasSubstr("the pattern has 50331 frames (at most 5000)"));
}

TEST(WalkingPattern, RefusesAnotherRobot) {
  const auto quadruped = load_urdf(FIXTURES_DIR "/models/quadruped.urdf");
  ASSERT_TRUE(quadruped);
  EXPECT_THAT(mistake(*quadruped, {}), HasSubstr("has no joint LLEG_HIP_R"));
}

}  // namespace
}  // namespace rehearse::tool
