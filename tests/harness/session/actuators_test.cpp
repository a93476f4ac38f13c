// Actuators in the loop: what a recording has of them, remarks, replays and branches. Their formulas are tested in
// tests/engine/world/actuators_test.cpp.

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ActuatorsInTheLoop : public RunTest {
 protected:
  static std::string with_actuators(const std::string& rules, const std::string& options,
                                    const std::string& duration = "0.05") {
    return rig(behaviour("C", options, ", delay: false"), "cameras: none\n", duration) + "    actuators: [" + rules +
           "]\n";
  }
};

TEST_F(ActuatorsInTheLoop, CommandAndEffortAreBothRecorded) {
  const Trace trace =
      record_run(with_actuators("{joint: SHOULDER, delay: 5 ms, effort: 2}", "drive effort 3 SHOULDER"));
  EXPECT_THAT(elements(trace, "/Rig/actuators"), ElementsAre("SHOULDER/q", "SHOULDER/dq", "SHOULDER/u"));
  for (std::size_t tick = 1; tick < 50; ++tick) {  // the effort of the step before
    EXPECT_EQ(trace.values("Rig/C/output/SHOULDER/u").at(tick), 3.0);
    EXPECT_EQ(trace.values("Rig/actuators/SHOULDER/u").at(tick), tick <= 5 ? 0.0 : 2.0) << tick;
    EXPECT_EQ(trace.values("Rig/SHOULDER/u").at(tick), tick <= 5 ? 0.0 : 2.0) << tick;
  }
}

TEST_F(ActuatorsInTheLoop, ABodyWithoutActuatorsHasNoChannelOfThem) {
  EXPECT_THAT(topics(record_run(rig_with("drive effort 3 SHOULDER")), "/Rig/actuators"), IsEmpty());
}

TEST_F(ActuatorsInTheLoop, AnActuatorThatLimitsIsARemark) {
  const Trace trace =
      record_run(with_actuators("{joint: \"*\", stall_effort: 2, no_load_velocity: 4}", "drive effort 3 SHOULDER"));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(summary_.remarks[0].message,
              HasSubstr("the actuator of joint 'SHOULDER' of 'Rig' limited 3 N·m to 1.999, at 0.004 rad/s"));
  record_run(with_actuators("{joint: \"*\", stall_effort: 20, no_load_velocity: 40}", "drive effort 3 SHOULDER"));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(ActuatorsInTheLoop, AnActuatorThatGetsHotIsARemark) {
  const std::string rules = "{joint: \"*\", effort: 5, continuous_effort: 2, thermal_time: 20 ms}";
  record_run(with_actuators(rules, "drive effort 3 SHOULDER"));  // hot after 20 ms * -ln(1 - 4/9) = 11.76 ms
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(
      summary_.remarks[0].message,
      HasSubstr("the actuator of joint 'SHOULDER' of 'Rig' is hot and exerts its continuous effort, 2 N·m, at"));
  record_run(with_actuators(rules, "drive effort 7 SHOULDER"));  // limited at once, and hot after that
  EXPECT_EQ(summary_.remarks.size(), 2u);
  record_run(with_actuators(rules, "drive effort 1.9 SHOULDER"));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(ActuatorsInTheLoop, JitterFollowsFromTheSeed) {
  const std::string text = with_actuators("{joint: SHOULDER, delay: 2 ms, jitter: 2 ms}", "drive effort 3 SHOULDER");
  const auto first = record_run(text).values("Rig/actuators/SHOULDER/u");
  EXPECT_EQ(record_run(text).values("Rig/actuators/SHOULDER/u"), first);
  EXPECT_NE(record_run("seed: 5\n" + text).values("Rig/actuators/SHOULDER/u"), first);
}

TEST_F(ActuatorsInTheLoop, AReplayAndABranchContinueTheCommandsUnderWay) {
  const std::string rules =
      "{joint: SHOULDER, delay: 5.5 ms, jitter: 1 ms, bandwidth: 40 Hz, armature: 0.1, backlash: 0.5 deg, efficiency: "
      "0.9, continuous_effort: 3, thermal_time: 50 ms, stiction: 0.2, position_gain: 40, velocity_gain: 2, period: 3 "
      "ms}";
  record_run(with_actuators(rules, "drive displacement 0.5 SHOULDER", "0.4"));
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
  BranchPoint point;
  point.trace = path("run.mcap").string();
  point.tick = 250;
  const auto branched = record_branch(point, path("branch.mcap"), {});
  ASSERT_TRUE(branched.ok()) << to_string(branched.errors());
  EXPECT_TRUE(branched->run.remarks.empty());
  const auto one = Trace::load(path("run.mcap")), other = Trace::load(path("branch.mcap"));
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_EQ(one->values("Rig/SHOULDER/q"), other->values("Rig/SHOULDER/q"));
  EXPECT_EQ(one->values("Rig/actuators/SHOULDER/q"), other->values("Rig/actuators/SHOULDER/q"));
}

TEST_F(ActuatorsInTheLoop, ASensorOfTheScenarioIsRecordedAndReplayed) {
  const std::string text = rig(behaviour("C", "drive effort 3 SHOULDER"), "cameras: none\n", "0.05") +
                           "    sensors: [{name: Extra, type: gyro, link: ARM}]\n";
  const Trace trace = record_run(text);
  EXPECT_EQ(trace.values("Rig/Extra/angular_velocity/y"), trace.values("Rig/Gyro/angular_velocity/y"));
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
}

}  // namespace
}  // namespace rehearse
