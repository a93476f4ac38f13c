// The order of calls of controllers, and the effect of a refusal.

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Lifecycle = RunTest;

TEST_F(Lifecycle, CallsComeInChoreonoidsOrder) {
  const std::string family = "{name: P, library: Behaviours, options: narrate, children: [" +
                             behaviour("Child", "narrate") + "]}, " + behaviour("Next", "narrate");
  EXPECT_THAT(said(record_run(rig(family))),
              ElementsAre("Rig/P: configure", "Rig/Child: configure", "Rig/Next: configure",     //
                          "Rig/P: initialize", "Rig/Child: initialize", "Rig/Next: initialize",  //
                          "Rig/P: start", "Rig/Child: start", "Rig/Next: start",                 //
                          "Rig/P: control", "Rig/Child: control", "Rig/Next: control",           //
                          "Rig/Next: stop", "Rig/Child: stop", "Rig/P: stop",                    //
                          "Rig/P: unconfigure", "Rig/Child: unconfigure", "Rig/Next: unconfigure"));
}

TEST_F(Lifecycle, MessagesCarryTheTickInWhichTheyWereSaid) {
  const Trace trace = record_run(rig_with("narrate"));
  EXPECT_EQ(trace.events().front().tick, 0);
  EXPECT_EQ(trace.events().back().tick, 19);
  EXPECT_EQ(trace.events().front().severity, "note");
  EXPECT_THAT(summary_.remarks, IsEmpty());  // messages are no remarks
}

TEST_F(Lifecycle, StopSeesTheTimeOfTheEnd) {
  EXPECT_THAT(said(record_run(rig_with("tell_end"))), ElementsAre("Rig/C: stopped at 0.02 s"));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  EXPECT_EQ(report->words.lines, 1) << "the same in a replay, which compares what is said";
}

class Refusals : public RunTest, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Function, Refusals, ::testing::Values("configure", "initialize", "start"));

TEST_P(Refusals, EndTheRunBeforeItsFirstTick) {
  const std::string function = GetParam();
  record_run(rig(behaviour("Bad", "refuse " + function) + ", " + behaviour("Good", "push 1")));
  EXPECT_EQ(summary_.ticks, 0);
  EXPECT_TRUE(summary_.controller_refused);
  ASSERT_TRUE(summary_.failure);
  EXPECT_EQ(summary_.failure->message, "controller 'Rig/Bad' refuses to take part: " + function + "() returned false");
  EXPECT_THAT(summary_.failure->hint, HasSubstr("`optional: true`"));
}

TEST_P(Refusals, OfAnOptionalControllerDropItAndTheRunGoesOn) {
  const std::string function = GetParam();
  const Trace trace =
      record_run(rig(behaviour("Bad", "refuse " + function, ", optional: true") + ", " + behaviour("Good", "push 1")));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_FALSE(summary_.controller_refused);
  EXPECT_FALSE(summary_.failure.has_value());
  EXPECT_THAT(said(trace),
              ElementsAre("Rig/Bad: " + function + "() returned false: the run goes on without this controller"));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
  EXPECT_GT(trace.last("Rig/SHOULDER/dq"), 0.03);
  EXPECT_EQ(trace.last("controller_results/0"), 0.0);
}

TEST_P(Refusals, AreRepeatedByAReplay) {
  record_run(rig(behaviour("Bad", std::string("refuse ") + GetParam(), ", optional: true") + ", " +
                 behaviour("Good", "push 1")));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  EXPECT_FALSE(report->controller_refused);
  EXPECT_EQ(report->ticks, 20);
}

TEST_F(Lifecycle, AParentThatRefusesLeavesItsChildrenRunning) {
  const std::string family = "{name: P, library: Behaviours, optional: true, options: refuse initialize, children: [" +
                             behaviour("Child", "push 1") + "]}";
  EXPECT_GT(record_run(rig(family)).last("Rig/SHOULDER/dq"), 0.03);
}

TEST_F(Lifecycle, ALibraryThatIsNotThereStopsTheRunBeforeItBegins) {
  const Scenario scenario = load(rig("{name: C, library: NoSuchController}"));
  const auto summary = record(scenario, path("none.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.errors()[0].message, HasSubstr("controller library 'NoSuchController' not found"));
  EXPECT_THAT(summary.errors()[0].file, HasSubstr("run.yaml"));
  EXPECT_GT(summary.errors()[0].line, 0);
  EXPECT_FALSE(std::filesystem::exists(path("none.mcap")));
}

TEST_F(Lifecycle, ALibraryThatIsNoLibraryIsRefused) {
  write("text.so", "this is no shared library, however long the text may be that stands in it\n");
  const auto summary = record(load(rig("{name: C, library: text.so}")), path("none.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.errors()[0].message, HasSubstr("'text.so' is not a shared library"));
}

TEST_F(Lifecycle, EveryLibraryThatDoesNotLoadIsNamed) {
  const auto summary = record(load(rig("{name: A, library: NoA}, {name: B, library: NoB}")), path("none.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.errors().size(), 2u);
}

TEST_F(Lifecycle, AnOptionForAControllerThatIsNotThereIsRefused) {
  RecordOptions options;
  options.libraries["Nobody"] = "Behaviours";
  const auto summary = record(load(rig_with("push 1")), path("none.mcap"), options);
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.errors()[0].message, HasSubstr("there is no controller 'Nobody'"));
  EXPECT_THAT(summary.errors()[0].hint, HasSubstr("Rig/C"));
}

TEST_F(Lifecycle, OptionsThatCannotBeSplitFailTheControllerThatSplitsThem) {
  record_run(rig(behaviour("C", "push \\\\q")));
  ASSERT_TRUE(summary_.failure);
  EXPECT_THAT(summary_.failure->message, HasSubstr("controller 'Rig/C' threw std::invalid_argument: option string, "
                                                   "character 6: a backslash stands before 'q'"));
}

TEST_F(Lifecycle, OptionsThatNobodySplitsMayHoldABackslash) {
  record_run(rig(R"({name: C, library: HingePd, options: 'C:\motions'})"));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_FALSE(summary_.failure);
}

}  // namespace
}  // namespace rehearse
