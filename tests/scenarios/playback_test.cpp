// A gripper without dynamics that plays a motion back.
#include <rehearse/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

namespace {

using rehearse::Trace;

// The motion is that of this build, whatever share folder the user has for other controllers.
const bool has_no_other_share_folder = unsetenv("REHEARSE_CHOREONOID_SHARE") == 0;

const Trace& playback() {
  static const Trace trace = rehearse::record("scenarios/playback.yaml");
  return trace;
}

TEST(Playback, PicksUpABlock) {
  const double on_the_table = playback().at("Block/Block/position/z", 1.0);
  EXPECT_NEAR(on_the_table, 0.025, 1e-3);                                             // [m]
  EXPECT_NEAR(playback().last("Block/Block/position/z"), on_the_table + 0.1, 0.002);  // the way of the gripper
  EXPECT_NEAR(playback().last("Block/Block/position/y"), 0.05, 0.005);
  EXPECT_MATCHES_GOLDEN(playback());
}

TEST(Playback, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Playback.PicksUpABlock"); }

TEST(Playback, IsExactlyWhereTheMotionSays) {
  const Trace& trace = playback();
  EXPECT_NEAR(trace.at("Gripper/PALM/position/z", 0.2), 0.5 * (0.30 + 0.13), 1e-12);  // between two frames
  EXPECT_NEAR(trace.at("Gripper/PALM/position/z", 0.4), 0.13, 1e-12);
  EXPECT_NEAR(trace.at("Gripper/LEFT/q", 1.2), 0.0146, 1e-12);
  for (const double time : {0.0, 0.5, 1.0, 2.0, 3.0})
    EXPECT_NEAR(trace.at("Gripper/RIGHT/q", time), -trace.at("Gripper/LEFT/q", time), 1e-15) << time;
}

TEST(Playback, TheBlockIsHeldWithoutSlipping) {
  for (double time = 1.7; time < 3.0; time += 0.1) {
    const double below = playback().at("Gripper/PALM/position/z", time) - playback().at("Block/Block/position/z", time);
    EXPECT_NEAR(below, 0.075, 0.003) << time;  // [m]
  }
}

TEST(Playback, RefusesAMotionOfAnotherRobot) {
  rehearse::BenchOptions options;
  options.options = "motion/sr1_squat.seq";
  EXPECT_THROW(rehearse::ControllerBench("PlaybackController", "models/pendulum.urdf", options), std::runtime_error);
}

}  // namespace
