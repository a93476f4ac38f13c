// Unexpected behaviour of Choreonoid's host on which controllers rely.

#include <bit>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class Traps : public RunTest {
 protected:
  /// The joint's velocity at the beginning of each tick.
  static std::vector<double> speed(const Trace& trace) { return trace.values("Rig/SHOULDER/dq"); }

  std::vector<std::string> input_elements(const std::string& mode) {
    return elements(record_run(rig_with("defaults " + mode)), "/Rig/C/input/joints");
  }
};

TEST_F(Traps, ControlReturningFalseDoesNotEndTheRun) {
  const Trace trace = record_run(rig_with("push 1 false"));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_FALSE(summary_.failure.has_value());
  EXPECT_FALSE(summary_.controller_refused);
  EXPECT_THAT(trace.values("controller_results/0"), Each(0.0));
  EXPECT_GT(trace.last("Rig/SHOULDER/dq"), 0.03);  // the command was effective to the end
}

/// As in Choreonoid's active control period: the step in which the last one says so is made.
TEST_F(Traps, ControlReturningFalseEndsTheRunIfTheScenarioSaysSo) {
  const std::string head = "cameras: none\nends_when_done: true\n";
  const Trace trace = record_run(rig(behaviour("C", "push 1 false"), head));
  EXPECT_EQ(summary_.ticks, 1);
  EXPECT_FALSE(summary_.failure.has_value());
  EXPECT_EQ(trace.values("Rig/SHOULDER/dq").size(), 2u);  // the state after the step is there
  record_run(rig(behaviour("C", "push 1 false") + ", " + behaviour("D", "push 1"), head));
  EXPECT_EQ(summary_.ticks, 20) << "one isn't done";
  record_run(rig("", head));
  EXPECT_EQ(summary_.ticks, 20) << "nobody is done where nobody is";
}

TEST_F(Traps, CommandsActOneTickLate) {
  const std::vector<double> dq = speed(record_run(rig_with("push 1")));
  EXPECT_EQ(dq[0], 0.0);
  EXPECT_EQ(dq[1], 0.0);
  EXPECT_NEAR(dq[2], 0.002, 1e-9);
}

TEST_F(Traps, NoDelayModeActsInTheSameTick) {
  const std::vector<double> by_controller = speed(record_run(rig_with("push 1 nodelay")));
  EXPECT_NEAR(by_controller[1], 0.002, 1e-9);
  const std::vector<double> by_scenario = speed(record_run(rig(behaviour("C", "push 1", ", delay: false"))));
  EXPECT_NEAR(by_scenario[1], 0.002, 1e-9);
}

TEST_F(Traps, OnlyTheParentsNoDelayFlagCounts) {
  const std::string parent_waits =
      "{name: P, library: Behaviours, options: \"push 0\", children: [" + behaviour("C", "push 1 nodelay") + "]}";
  EXPECT_EQ(speed(record_run(rig(parent_waits)))[1], 0.0);
  const std::string parent_hurries =
      "{name: P, library: Behaviours, options: \"push 0 nodelay\", children: [" + behaviour("C", "push 1") + "]}";
  EXPECT_NEAR(speed(record_run(rig(parent_hurries)))[1], 0.002, 1e-9);
}

TEST_F(Traps, StepZeroRunsWithoutCommand) {
  // An effort u written in initialize() doesn't act in step 0; it stays in the body, and control() sends it from tick 0
  // on.
  const Trace trace = record_run(rig_with("early"));
  const std::vector<double> dq = speed(trace);
  EXPECT_EQ(dq[1], 0.0);
  EXPECT_NEAR(dq[2], 0.01, 1e-9);
  EXPECT_THAT(trace.values("Rig/C/output/SHOULDER/u"), Each(5.0));
}

TEST_F(Traps, ADriveHoldsTheInitialPostureInStepZero) {
  const Trace trace = record_run(rig_with("drive displacement 0.2504 RAIL"));
  const std::vector<double> q = trace.values("Rig/RAIL/q");
  EXPECT_NEAR(q[1], 0.25, 1e-9);
  EXPECT_NEAR(q[2], 0.2504, 1e-6);
}

TEST_F(Traps, EnableOutputWithFlagsSetsTheMode) {
  const Trace trace = record_run(rig_with("drive velocity 3"));
  EXPECT_THAT(said(trace), Contains("Rig/C: mode 2"));
  EXPECT_NEAR(speed(trace)[2], 3.0, 1e-6);
  EXPECT_THAT(elements(trace, "/Rig/C/output/joints"), ElementsAre("SHOULDER/dq"));
}

TEST_F(Traps, EnableOutputWithoutAModeSendsNothing) {
  const Trace trace = record_run(rig_with("drive none 3"));
  EXPECT_THAT(topics(trace, "/Rig/C/output"), IsEmpty());
  EXPECT_EQ(trace.last("Rig/SHOULDER/dq"), 0.0);
}

TEST_F(Traps, TheDefaultInputOfEveryJointModeIsTheDisplacementAlone) {
  EXPECT_THAT(input_elements("effort"), ElementsAre("SHOULDER/q"));
  EXPECT_THAT(input_elements("velocity"), ElementsAre("SHOULDER/q"));
  EXPECT_THAT(input_elements("displacement"), ElementsAre("SHOULDER/q"));  // the manual page states: none
}

TEST_F(Traps, TheDefaultInputOfNoModeIsNothing) {
  EXPECT_THAT(topics(record_run(rig_with("defaults none")), "/Rig/C/"), IsEmpty());
}

TEST_F(Traps, TheDefaultInputOfLinkPositionModeIsNothing) {
  EXPECT_THAT(topics(record_run(rig_with("defaults position")), "/Rig/C/"), IsEmpty());
}

TEST_F(Traps, TheDefaultInputOfExternalWrenchModeIsTheLinksPosition) {
  EXPECT_THAT(topics(record_run(rig_with("defaults wrench")), "/Rig/C/"), ElementsAre("/Rig/C/input/ARM/pose"));
}

TEST_F(Traps, DisabledInputsKeepStaleValues) {
  const std::string pushed = "cameras: none\npushes: [{body: Rig, link: SLED, force: [50, 0, 0], from: 0, until: 1}]\n";
  const Trace trace = record_run(rig(behaviour("C", "stale"), pushed));
  EXPECT_GT(trace.last("Rig/RAIL/q"), 0.254);
  EXPECT_THAT(trace.values("Rig/C/output/RAIL/u"), Each(0.25));  // its position before the run
}

TEST_F(Traps, OwnOutputsAreReadableBack) {
  const std::vector<double> u = record_run(rig_with("stale")).values("Rig/C/output/SHOULDER/u");
  for (std::size_t i = 0; i < u.size(); ++i) ASSERT_EQ(u[i], static_cast<double>(i) + 1.0);
}

TEST_F(Traps, ExternalWrenchesOfTwoControllersAddUp) {
  const std::string text =
      "rehearse: 1\nduration: 0.02\ngravity: [0, 0, 0]\nbodies:\n  - name: Box\n    box: {size: [1, 1, 1]}\n"
      "    mass: 2\n    position: [5, 0, 0]\n    controllers: [" +
      behaviour("A", "wrench 4 0 0") + ", " + behaviour("B", "wrench 0 2 0") + "]\n";
  const Trace trace = record_run(text);
  EXPECT_NEAR(trace.last("Box/Box/linear/x"), 2.0 * 0.019, 1e-9);
  EXPECT_NEAR(trace.last("Box/Box/linear/y"), 1.0 * 0.019, 1e-9);
  // about the world's origin, so that a force through the centre doesn't turn a box at a different place
  EXPECT_NEAR(trace.last("Box/Box/angular/z"), 0.0, 1e-3);
}

TEST_F(Traps, OfTwoControllersTheLastOneWins) {
  const Trace trace = record_run(rig(behaviour("A", "push 1") + ", " + behaviour("B", "push -1")));
  EXPECT_LT(trace.last("Rig/SHOULDER/dq"), 0.0);
}

TEST_F(Traps, EnableAfterInitializeIsIgnoredAndSaid) {
  const Trace trace = record_run(rig_with("late"));
  EXPECT_THAT(topics(trace, "/Rig/C/"), ElementsAre("/Rig/C/output/joints"));
  EXPECT_THAT(said(trace), Contains(HasSubstr("enabled an input or output after initialize(): it has no effect")));
  ASSERT_EQ(summary_.remarks.size(), 1u) << "once, and not in the recording alone";
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
}

TEST_F(Traps, FrameZeroSensorsReadZero) {
  EXPECT_THAT(said_by_controllers(record_run(rig_with("sense"))),
              ElementsAre("Rig/C: tick 0 accelerometer 0 imu 0 force 0",
                          "Rig/C: tick 1 accelerometer 9.80665 imu 9.80665 force -9.80665"));
}

TEST_F(Traps, ADeviceWithoutEnabledInputStaysAsItWas) {
  EXPECT_THAT(record_run(rig_with("blind")).values("Rig/C/output/SHOULDER/u"), Each(0.0));
}

TEST_F(Traps, OptionsOfTheRunComeFirst) {
  const Trace trace =
      record_run(rig(behaviour("C", "options \\\"own words\\\" last"), "cameras: none\noptions: of the run\n"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: configure: options \"own words\" last",
                                       "Rig/C: initialize: of the run options \"own words\" last",
                                       "Rig/C: [of][the][run][options][own words][last]"));
}

TEST_F(Traps, CurrentTimeIsTickOverRate) {
  const Trace trace = record_run(rig(behaviour("C", "clock"), "cameras: none\ntime_step: 0.003\n", "0.6"));
  const std::vector<double> now = trace.values("Rig/C/output/SHOULDER/u");
  ASSERT_EQ(now.size(), 200u);
  bool differs_from_product = false;
  for (std::size_t tick = 0; tick < now.size(); ++tick) {
    const double expected = static_cast<double>(tick) / (1.0 / 0.003);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(now[tick]), std::bit_cast<std::uint64_t>(expected)) << "tick " << tick;
    differs_from_product |= expected != static_cast<double>(tick) * 0.003;
  }
  EXPECT_TRUE(differs_from_product);
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: initialize at 0 step 0.003", "Rig/C: start at 0"));
}

class DeviceTraps : public RunTest {
 protected:
  /// How many messages the camera's channel has after 40 ticks, one every 5 ms from tick 5 on if it stays on.
  std::size_t pictures(const std::string& options) {
    return record_run(rig(behaviour("C", options), "", "0.04")).find_channel("/Rig/Camera/image")->messages();
  }
};

TEST_F(DeviceTraps, DeviceOutputNeedsNotify) {
  EXPECT_EQ(pictures("push 0"), 8u);  // at ticks 5, 10, ..., and in the state after the last tick
  EXPECT_EQ(pictures("switch 12"), 8u);
  // at ticks 5 and 10; the third message reports that the picture was removed
  EXPECT_EQ(pictures("switch 12 notify"), 3u);
  EXPECT_EQ(summary_.pictures, 4);  // two of colour and two of depth
}

TEST_F(DeviceTraps, WithoutDelayDeviceOutputIsNotLost) { EXPECT_EQ(pictures("switch 12 notify nodelay"), 3u); }

TEST_F(DeviceTraps, NotifyInInitializeCounts) {
  EXPECT_EQ(pictures("switch -1 notify"), 1u);  // only the message that the camera is off
  EXPECT_EQ(summary_.pictures, 0);
}

TEST_F(Traps, ChildrenShareTheBodySiblingsDoNot) {
  const std::string family = "{name: P, library: Behaviours, options: \"mark 42\", children: [" +
                             behaviour("Child", "read_mark") + "]}, " + behaviour("Sibling", "read_mark");
  const Trace trace = record_run(rig(family));
  EXPECT_THAT(trace.values("Rig/Child/output/SHOULDER/u"), Each(42.0));
  EXPECT_THAT(trace.values("Rig/Sibling/output/SHOULDER/u"), Each(0.0));
}

TEST_F(Traps, AChildAddsToWhatItsParentCommands) {
  const std::string family =
      "{name: P, library: Behaviours, options: \"push 1\", children: [" + behaviour("Child", "add 10") + "]}";
  const Trace trace = record_run(rig(family));
  EXPECT_THAT(trace.values("Rig/P/output/SHOULDER/u"), Each(11.0));
  EXPECT_THAT(trace.values("Rig/Child/output/SHOULDER/u"), Each(11.0));
}

TEST_F(Traps, ALinkCannotBeMovedByItsPosition) {
  const Trace trace = record_run(rig_with("teleport"));
  EXPECT_THAT(said(trace), Contains(HasSubstr("link 'world' can't be moved by command")));
}

TEST_F(Traps, NullLinkFailsCleanly) {
  const Trace trace = record_run(rig_with("fail null_input initialize"));
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_EQ(summary_.failure->message,
            "controller 'Rig/C' threw std::invalid_argument: enableInput: the link is null in "
            "initialize() at tick 0 (0 s)");
}

TEST_F(Traps, AHingeAngleIsUnwrapped) {
  const Trace trace = record_run(rig(behaviour("C", "drive velocity 50"), "cameras: none\n", "0.5"));
  EXPECT_NEAR(trace.last("Rig/SHOULDER/q"), 50.0 * 0.499, 0.1);  // Choreonoid's ODE item would wrap it to [-pi, pi]
}

TEST_F(Traps, EverythingThatCanBeReadIsRecorded) {
  const Trace trace = record_run(rig_with("all"));
  EXPECT_THAT(topics(trace, "/Rig/C/"),
              UnorderedElementsAre("/Rig/C/input/joint_accelerations", "/Rig/C/input/joints", "/Rig/C/input/ARM/pose",
                                   "/Rig/C/input/ARM/twist", "/Rig/C/input/ARM/accel"));
  EXPECT_THAT(elements(trace, "/Rig/C/input/joints"), UnorderedElementsAre("SHOULDER/q", "SHOULDER/dq", "SHOULDER/u"));
}

}  // namespace
}  // namespace rehearse
