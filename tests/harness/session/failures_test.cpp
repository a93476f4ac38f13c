// A controller may throw, crash or hang: the run ends, its trace is complete up to there, and a replay fails in the
// same way.

#include <cmath>
#include <limits>

#include "runs.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

struct Failure {
  const char* name;
  const char* what;  // in the message
};

std::string failure_name(const ::testing::TestParamInfo<Failure>& failure) { return failure.param.name; }

constexpr double call_limit = 2.0;  // [s]; an overflow touches the whole stack, which takes a while under load

class FailureInControl : public RunTest, public ::testing::WithParamInterface<Failure> {};
INSTANTIATE_TEST_SUITE_P(How, FailureInControl,
                         ::testing::Values(Failure{"throw", "threw std::runtime_error: no gait for this slope"},
                                           Failure{"throw_int", "threw something that is no std::exception: int"},
                                           Failure{"null", "crashed: segmentation fault"},
                                           Failure{"abort", "crashed: it called abort"},
                                           Failure{"overflow", "crashed: its stack overflowed"},
                                           Failure{"exit", "called exit(0)"}, Failure{"_exit", "called _exit(3)"},
                                           Failure{"quick_exit", "called quick_exit(1)"},
                                           Failure{"hang", "did not return within 2 s"}),
                         failure_name);

TEST_P(FailureInControl, EndsTheRunAndLeavesAWholeTrace) {
  const std::string bad = behaviour("Bad", std::string("fail ") + GetParam().name + " control 7");
  const Trace trace = record_run(rig(behaviour("First", "push 0") + ", " + bad + ", " + behaviour("Last", "push 0")),
                                 "run.mcap", call_limit);
  ASSERT_TRUE(summary_.failure.has_value());
  const std::string& message = summary_.failure->message;
  EXPECT_THAT(message, HasSubstr("controller 'Rig/Bad' "));
  EXPECT_THAT(message, HasSubstr(GetParam().what));
  EXPECT_THAT(message, HasSubstr("in control() at tick 7 (0.007 s)"));
  EXPECT_EQ(summary_.ticks, 8);
  EXPECT_EQ(trace.ticks(), 8);
  EXPECT_THAT(said(trace), Contains("Rig/Bad: " + message));
  EXPECT_EQ(trace.events().back().tick, 7);
  EXPECT_EQ(trace.find_metadata("rehearse.outcome")->at("complete"), "false");
  EXPECT_EQ(trace.find_metadata("rehearse.outcome")->at("failure"), message);
  // The fatal tick contains the calls before the failure, but no output of the failed call; later controllers weren't
  // called.
  EXPECT_THAT(trace.values("Rig/First/output/SHOULDER/u"), SizeIs(8));
  EXPECT_THAT(trace.values("Rig/Bad/output/SHOULDER/u"), SizeIs(7));
  EXPECT_THAT(trace.values("Rig/Last/output/SHOULDER/u"), SizeIs(7));
}

TEST_P(FailureInControl, IsRepeatedByAReplayAtTheSameTick) {
  record_run(rig_with(std::string("fail ") + GetParam().name + " control 7"), "run.mcap", call_limit);
  ReplayOptions options;
  options.call_limit = call_limit;
  const auto report = replay_run(options);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  ASSERT_TRUE(report->failure.has_value());
  EXPECT_EQ(report->failure->message, summary_.failure->message);
  EXPECT_FALSE(report->first.has_value());
  EXPECT_EQ(report->ticks, 7);
}

class FailureBeforeTheRun : public RunTest, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Function, FailureBeforeTheRun, ::testing::Values("configure", "initialize", "start"));

TEST_P(FailureBeforeTheRun, LeavesATraceWithoutTicks) {
  const std::string function = GetParam();
  const Trace trace = record_run(rig_with("fail throw " + function));
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_EQ(summary_.failure->message, "controller 'Rig/C' threw std::runtime_error: no gait for this slope in " +
                                           function + "() at tick 0 (0 s)");
  EXPECT_EQ(summary_.ticks, 0);
  EXPECT_EQ(trace.ticks(), 0);
  EXPECT_THAT(said(trace), Contains("Rig/C: " + summary_.failure->message));
}

TEST_P(FailureBeforeTheRun, IsRepeatedByAReplay) {
  record_run(rig_with(std::string("fail throw ") + GetParam()));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  ASSERT_TRUE(report->failure.has_value());
  EXPECT_EQ(report->failure->message, summary_.failure->message);
}

using Failures = RunTest;

TEST_F(Failures, InStopComesAfterAWholeRun) {
  record_run(rig_with("fail throw stop"));
  EXPECT_EQ(summary_.ticks, 20);
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_THAT(summary_.failure->message, HasSubstr("in stop()"));
}

TEST_F(Failures, OfOneControllerLetTheOthersStop) {
  const Trace trace = record_run(rig(behaviour("Bad", "fail null control 3") + ", " + behaviour("Other", "narrate")));
  EXPECT_THAT(said(trace), Contains("Rig/Other: stop"));
  EXPECT_THAT(said(trace), Contains("Rig/Other: unconfigure"));
}

TEST_F(Failures, LeaveTheNextRunInTheProcessUntouched) {
  record_run(rig_with("push 1"), "before.mcap");
  for (const char* how : {"null", "overflow", "abort", "throw"})
    record_run(rig_with(std::string("fail ") + how + " control 3"));
  record_run(rig_with("push 1"), "after.mcap");
  EXPECT_EQ(bytes("before.mcap"), bytes("after.mcap"));
}

class OddNumbers : public RunTest, public ::testing::WithParamInterface<Failure> {};
INSTANTIATE_TEST_SUITE_P(Which, OddNumbers,
                         ::testing::Values(Failure{"nan", "wrote nan"}, Failure{"infinity", "wrote -inf"}),
                         failure_name);

TEST_P(OddNumbers, AreRecordedAndReportedAndNeverReachTheRobot) {
  const Trace trace = record_run(rig_with(std::string("fail ") + GetParam().name + " control 7"));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_FALSE(summary_.failure.has_value());
  const std::vector<double> u = trace.values("Rig/C/output/SHOULDER/u");
  EXPECT_FALSE(std::isfinite(u[7]));
  EXPECT_EQ(u[6], 1.0);
  EXPECT_EQ(u[8], 1.0);
  EXPECT_THAT(said(trace),
              Contains("Rig/C: " + std::string(GetParam().what) +
                       " into u of joint 'SHOULDER' at tick 7 (0.007 s); it was recorded, but the robot keeps "
                       "the command before it"));
  // it continues with 1 N·m as before: 18 steps of 2 rad/s² after the first, which had no command
  EXPECT_NEAR(trace.last("Rig/SHOULDER/dq"), 2.0 * 0.019, 1e-6);
  EXPECT_EQ(trace.values("Rig/SHOULDER/u")[9], 1.0);
  ASSERT_EQ(summary_.remarks.size(), 1u);
}

TEST_P(OddNumbers, AreTheSameBitsInAReplay) {
  record_run(rig_with(std::string("fail ") + GetParam().name + " control 7"));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << to_string(*report->first);
}

TEST_F(Failures, AnAbsurdEffortExplodesTheSimulationAndSaysWhen) {
  record_run(rig_with("fail explode control 7"));
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_THAT(summary_.failure->message, HasSubstr("the simulation exploded in the step after tick 8"));
  EXPECT_EQ(summary_.ticks, 9);
}

TEST_F(Failures, OfTheExactSolverAreEventsAndTheFirstIsARemark) {
  const Trace trace = record_run(R"(rehearse: 1
duration: 0.05
solver: {method: exact}
bodies:
  - {name: Floor, box: {size: [10, 10, 0.2]}, fixed: true, position: [0, 0, -0.1]}
  - {name: Lower, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 0.1]}
  - {name: Upper, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 0.3]}
)");
  EXPECT_FALSE(summary_.failure.has_value());
  const std::string text =
      "world: the exact solver found no solution in the step after tick 0, when 'Floor', 'Lower', 'Upper' touched; "
      "the quick solver made the step with 1000 iterations (ODE message 3: LCP internal error";
  EXPECT_THAT(said(trace), Contains(HasSubstr(text)));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr(text));
  EXPECT_NEAR(trace.last("Upper/Upper/position/z"), 0.3, 1e-3);
}

TEST_F(Failures, AJointFasterThanAnyRobotsIsARemark) {
  const Trace trace = record_run(rig_with("push 10000000"));
  EXPECT_FALSE(summary_.failure.has_value());
  ASSERT_FALSE(summary_.remarks.empty());
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr("world: joint 'SHOULDER' of 'Rig' moves at 2e+04 rad/s"));
  EXPECT_THAT(said(trace), Contains(HasSubstr("moves at 2e+05 rad/s")));
}

TEST_F(Failures, AnIslandWithTooManyContactsForTheDirectSolverIsARemarkOnce) {
  std::string scenario = R"(rehearse: 1
duration: 0.01
solver: {method: direct}
joints:
  - {type: fixed, between: [Post, Tray]}
bodies:
  - {name: Post, box: {size: [0.1, 0.1, 0.9]}, fixed: true, position: [0, 0, 0.45]}
  - {name: Tray, box: {size: [3, 3, 0.02]}, mass: 5, position: [0, 0, 0.91]}
)";
  for (int i = 0; i < 30; ++i)
    scenario += "  - {name: Box" + std::to_string(i) + ", box: {size: [0.1, 0.1, 0.1]}, mass: 0.1, position: [" +
                std::to_string(0.3 * (i % 6) - 0.75) + ", " + std::to_string(0.3 * (i / 6) - 0.6) + ", 0.9699]}\n";
  const Trace trace = record_run(scenario);
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_EQ(
      summary_.remarks[0].message,
      "world: bodies that touch at 120 points, more than 100, are left to the quick solver in the step after tick "
      "0");
}

TEST_F(Failures, AFastMathControllerIsSetRightAndNamed) {
  const Trace trace =
      record_run(rig(behaviour("Fast", "fail flush control 3") + ", " + behaviour("Tester", "denormals")));
  EXPECT_THAT(said(trace),
              Contains("Rig/Fast: control() at tick 3 left another floating-point mode behind (flush-to-zero and "
                       "denormals-are-zero); it was set back (is it built with -ffast-math?)"));
  EXPECT_THAT(trace.values("Rig/Tester/output/SHOULDER/u"), ::testing::Each(1.0));
  ASSERT_EQ(summary_.remarks.size(), 2u) << "both command SHOULDER, which is told, too";
  EXPECT_THAT(summary_.remarks[1].message, HasSubstr("another floating-point mode"));
  EXPECT_EQ(summary_.remarks[1].severity, Severity::warning);
}

}  // namespace
}  // namespace rehearse
