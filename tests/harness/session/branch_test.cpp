// What if: altered inputs in a replay, and branches of recordings.
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/simulation/led_world.h"
#include "core/simulation/recorded_commands.h"
#include "core/trace/trace_windows.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BranchTest : public RunTest {
 protected:
  /// The wheel, away from its rest position, under a PD controller, for 200 ticks.
  void record_hinge() {
    record_run(
        "rehearse: 1\nduration: 0.2\ncameras: none\nbodies:\n  - name: Rig\n    model: rig.urdf\n"
        "    joints: {SHOULDER: 0.3}\n    controllers: [{name: C, library: HingePd}]\n");
  }

  BranchPoint at(std::int64_t tick) const { return {path("run.mcap"), std::nullopt, tick}; }

  BranchSummary branched(std::int64_t tick, const BranchOptions& options = {}) {
    const auto made = record_branch(at(tick), path("branch.mcap"), options);
    EXPECT_TRUE(made.ok()) << to_string(made.errors());
    return made ? *made : BranchSummary{};
  }

  Trace loaded(const std::string& file) const {
    auto trace = Trace::load(path(file));
    EXPECT_TRUE(trace.ok()) << to_string(trace.errors());
    return trace ? *std::move(trace) : Trace{};
  }

  std::string refusal(const BranchPoint& from, const BranchOptions& options = {}) const {
    const auto made = record_branch(from, path("refused.mcap"), options);
    EXPECT_FALSE(made.ok());
    EXPECT_FALSE(std::filesystem::exists(path("refused.mcap")));
    return made ? "" : to_string(made.errors());
  }

  std::string altering_refused(const std::string& text) const {
    ReplayOptions options;
    options.set = {text};
    const auto report = replay_run(options);
    EXPECT_FALSE(report.ok()) << text;
    return report ? "" : to_string(report.errors());
  }

  ReplayReport replayed_with(const std::vector<std::string>& set) const {
    ReplayOptions options;
    options.set = set;
    const auto report = replay_run(options);
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report ? *report : ReplayReport{};
  }

  std::vector<std::string> lines_and_warnings(const std::string& file) const { return said(loaded(file)); }

  /// Checks that the commands of the recording alone move the world as recorded.
  void expect_plant_repeats(const std::string& file) const {
    auto scenario = Scenario::load(path("run.yaml"));
    ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
    expect_the_same_without_controllers(*scenario, loaded(file));
  }
};

TEST_F(BranchTest, AlteredInputsReachTheControllerInTheirSpanAlone) {
  record_hinge();
  const ReplayReport report = replayed_with({"Rig/SHOULDER/q=0.5@tick:50..59"});
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->tick, 50);
  EXPECT_EQ(report.first->channel, "/Rig/C/output/joints");
  EXPECT_GE(report.ticks_different, 10);
  EXPECT_THAT(report.remarks, IsEmpty());
  EXPECT_EQ(replayed_with({"Rig/C/input/SHOULDER/q=0.5@0.05s..0.06s"}).first->tick, 50);
  EXPECT_EQ(replayed_with({"Rig/SHOULDER/q=0.5"}).first->tick, 0);
  EXPECT_EQ(replayed_with({"Rig/SHOULDER/q*=1"}).values_different, 0);
  EXPECT_EQ(replayed_with({"Rig/SHOULDER/q+=0@0.1s"}).values_different, 0);
  EXPECT_TRUE(std::isnan(replayed_with({"Rig/SHOULDER/q=nan@tick:7"}).first->actual));
  const double by_degrees = replayed_with({"Rig/SHOULDER/q=30deg@tick:7"}).first->actual;
  EXPECT_EQ(by_degrees, replayed_with({"Rig/SHOULDER/q=0.5235987755982988@tick:7"}).first->actual);
}

TEST_F(BranchTest, MistakesInAnAlterationAreShownAtTheirPlace) {
  record_hinge();
  EXPECT_THAT(altering_refused("Rig/SHOULDR/q=1"),
              HasSubstr("there is no input 'Rig/SHOULDR/q'; similar inputs: Rig/SHOULDER/q"));
  EXPECT_THAT(altering_refused("Rig/SHOULDR/q=1"), HasSubstr("\n  Rig/SHOULDR/q=1\n  ^~~~~~~~~~~~~"));
  EXPECT_THAT(altering_refused("Rig/RAIL/q=1"), HasSubstr("no controller reads 'Rig/RAIL/q'"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=one"), HasSubstr("'one' is no number, nor an angle"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=one"), HasSubstr("\n                 ^~~"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/dq=30deg"), HasSubstr("'30deg' is no number"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q"), HasSubstr("this alters nothing"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=1@tick:9..3"), HasSubstr("'tick:9..3' contains no tick"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=1@5"), HasSubstr("'5' is no span of time"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=1@tick:x"), HasSubstr("'tick:x' is no span of ticks"));
  EXPECT_THAT(altering_refused("Rig/SHOULDER/q=1@3s..4s"), HasSubstr("the run ends before that, at tick 199"));
}

TEST_F(BranchTest, AReplayCanBeWrittenAndRepeatsItself) {
  record_hinge();
  ReplayOptions options;
  options.set = {"Rig/SHOULDER/q+=0.1@tick:50..59"};
  const auto written = write_replay(path("run.mcap"), path("what_if.mcap"), options);
  ASSERT_TRUE(written.ok()) << to_string(written.errors());
  const auto again = replay_run({}, "what_if.mcap");
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_TRUE(again->equal()) << to_string(*again->first);
  EXPECT_EQ(again->ticks, 200);

  const Trace run = loaded("run.mcap"), what_if = loaded("what_if.mcap");
  EXPECT_EQ(what_if.values("Rig/SHOULDER/q"), run.values("Rig/SHOULDER/q")) << "the world is as it was";
  EXPECT_EQ(what_if.at("Rig/C/input/SHOULDER/q", 0.055), run.at("Rig/SHOULDER/q", 0.055) + 0.1);
  EXPECT_EQ(what_if.integers("state_hash"), run.integers("state_hash"));
  const mcap::StringMap& origin = *what_if.find_metadata("rehearse.branch");
  EXPECT_THAT(origin.at("source"), ::testing::StartsWith("run.mcap "));
  EXPECT_EQ(origin.at("loop"), "open");
  EXPECT_EQ(origin.at("set.1"), "Rig/SHOULDER/q+=0.1@tick:50..59");
  EXPECT_THAT(refusal({path("what_if.mcap"), std::nullopt, 10}), HasSubstr("it is a replay"));
}

TEST_F(BranchTest, AReplayThatChangesNothingIsWrittenAsItWas) {
  record_run(rig(behaviour("C", "feel"), "cameras: [Rig/Camera]\nseed: 3\n", "0.05"));
  ASSERT_TRUE(write_replay(path("run.mcap"), path("same.mcap"), {}).ok());
  const Comparison comparison = compare(loaded("run.mcap"), loaded("same.mcap"), {});
  for (const ChannelComparison& channel : comparison.channels)
    EXPECT_EQ(channel.channel, "/checkpoint") << to_string(*channel.first_bit);
}

TEST_F(BranchTest, AlteredSensorsAreRecordedAsTheyWereRead) {
  record_run(rig(behaviour("C", "feel"), "cameras: none\n", "0.05"));
  ReplayOptions options;
  options.set = {"Rig/Gyro/angular_velocity/y+=0.5@tick:10..12"};
  ASSERT_TRUE(write_replay(path("run.mcap"), path("what_if.mcap"), options).ok());
  const Trace run = loaded("run.mcap"), what_if = loaded("what_if.mcap");
  EXPECT_EQ(what_if.at("Rig/Gyro/angular_velocity/y", 0.011), run.at("Rig/Gyro/angular_velocity/y", 0.011) + 0.5);
  EXPECT_EQ(what_if.at("Rig/Gyro/angular_velocity/y", 0.013), run.at("Rig/Gyro/angular_velocity/y", 0.013));
  const auto again = replay_run({}, "what_if.mcap");
  ASSERT_TRUE(again.ok() && again->equal());
}

TEST_F(BranchTest, SaysWhereItCameFrom) {
  record_hinge();
  BranchOptions options;
  options.push = {"Rig/ARM force=0,0,5 at=0.1,0,0 @tick:150..159"};
  const BranchSummary branch = branched(120, options);
  EXPECT_EQ(branch.tick, 120);
  EXPECT_EQ(branch.run.ticks, 200);
  EXPECT_TRUE(branch.before.equal());
  const Trace trace = loaded("branch.mcap");
  const mcap::StringMap& origin = *trace.find_metadata("rehearse.branch");
  EXPECT_THAT(origin.at("source"), ::testing::StartsWith("run.mcap "));
  EXPECT_EQ(origin.at("loop"), "closed");
  EXPECT_EQ(origin.at("tick"), "120");
  EXPECT_EQ(origin.at("time"), "0.12");
  EXPECT_EQ(origin.at("push.1"), options.push[0]);
  EXPECT_EQ(origin.count("set.1"), 0u);
  EXPECT_EQ(origin.count("controller.1"), 0u);
}

TEST_F(BranchTest, IsItsSourceWithNoiseCamerasVariablesAndJoystick) {
  const std::string noise =
      "noise:\n  - {joint: Rig/SHOULDER, displacement: {stddev: 0.001}}\n"
      "  - {sensor: Rig/Gyro, angular_velocity: {stddev: 0.02}, dropout: 0.2}\n"
      "  - {sensor: Rig/Camera, depth: {stddev: 0.05}, dropout: 0.3, exposure: 3 ms, readout: 1.5 ms}\n";
  const std::string joystick = "joystick:\n  - {at: 0.05, axes: {L_STICK_V: 0.5}}\n";
  for (const std::string& controller :
       {behaviour("C", "all"), behaviour("C", "variables 0.5"), behaviour("C", "lines")}) {
    record_run(rig(controller, "cameras: [Rig/Camera]\n", "0.25") + noise + joystick);
    for (const std::int64_t tick : {0, 1, 101, 249}) {
      branched(tick);
      const Comparison comparison = compare(loaded("run.mcap"), loaded("branch.mcap"), {});
      EXPECT_TRUE(comparison.equal) << controller << " at " << tick << ": " << verdict(comparison);
      EXPECT_THAT(comparison.remarks, IsEmpty());
      EXPECT_EQ(lines_and_warnings("run.mcap"), lines_and_warnings("branch.mcap")) << tick;
    }
  }
}

TEST_F(BranchTest, CopiesChunksOfControllersThatRepeatThemselvesAlone) {
  record_run(rig(behaviour("C", "all"), "cameras: [Rig/Camera]\n", "4.5"));
  const BranchSummary repeated = branched(4100);
  EXPECT_GE(repeated.copied_chunks, 4) << "one each second, at least";
  EXPECT_EQ(repeated.before.ticks, 4100);
  const auto source = *mcap::Reader::open(path("run.mcap")), branch = *mcap::Reader::open(path("branch.mcap"));
  EXPECT_TRUE(branch->can_copy_chunks());
  EXPECT_EQ(branch->statistics()->message_count, source->statistics()->message_count);
  EXPECT_EQ(branch->statistics()->channel_message_counts, source->statistics()->channel_message_counts);
  EXPECT_EQ(branch->chunks().size(), source->chunks().size());
  BranchOptions altering;
  altering.set = {"Rig/SHOULDER/q+=0.001@tick:10"};
  EXPECT_EQ(branched(4100, altering).copied_chunks, 0);
}

TEST_F(BranchTest, ReadsCheckpointsAndCommandsNearItsMomentAlone) {
  const std::string drive = behaviour("C", "push 0.1"), once = behaviour("C", "once 0.1");
  for (const auto& [controller, first] : {std::pair(drive, 3000), std::pair(once, 0)}) {
    record_run(rig(controller, "cameras: none\n", "4.5"));
    const auto scenario = Scenario::load(path("run.yaml"));
    const auto sizes = load_sizes(path("run.mcap"));
    ASSERT_TRUE(scenario.ok() && sizes.ok());
    const std::vector<std::int64_t> ticks = checkpoints_before(*sizes, *scenario, 4100).ticks();
    ASSERT_FALSE(ticks.empty());
    EXPECT_GE(ticks.front(), 2500) << "of 45 checkpoints";
    EXPECT_LE(ticks.back(), 4100);
    auto commands = RecordedCommands::find(*scenario, *sizes);
    ASSERT_TRUE(commands.ok());
    EXPECT_EQ(commands->pass_over(4000), first);
  }
}

TEST_F(BranchTest, KnowsCommandsInForceThatWereGivenLongBeforeTheCheckpoint) {
  record_run(rig(behaviour("C", "once 0.2"), "cameras: none\n", "2.5"));
  const BranchSummary branch = branched(2300);
  EXPECT_THAT(branch.world, HasSubstr("checkpoint of tick 2200"));
  EXPECT_THAT(branch.run.remarks, IsEmpty()) << "the world is the recorded one";
  EXPECT_TRUE(compare(loaded("run.mcap"), loaded("branch.mcap"), {}).equal);
}

TEST_F(BranchTest, CallsControllersThatRepeatTheirCommandsOnce) {
  record_run(rig(behaviour("C", "lines"), "", "0.25"));
  int lines = 0;
  BranchOptions options;
  options.on_message = [&lines](const std::string&, const std::string&) { ++lines; };
  EXPECT_TRUE(branched(249, options).before.equal());
  EXPECT_EQ(lines, std::ssize(lines_and_warnings("branch.mcap")));
  EXPECT_GT(lines, 5);
}

TEST_F(BranchTest, APushMovesTheWorldFromItsTickOnAndTheBranchRepeatsItself) {
  record_hinge();
  BranchOptions options;
  options.push = {"Rig/ARM torque=0,3,0 @tick:150..159"};
  branched(120, options);
  const Trace run = loaded("run.mcap"), branch = loaded("branch.mcap");
  const std::vector<double> before = run.values("Rig/SHOULDER/q"), after = branch.values("Rig/SHOULDER/q");
  ASSERT_EQ(before.size(), after.size());
  const auto [then, now] = std::mismatch(before.begin(), before.end(), after.begin());
  EXPECT_EQ(then - before.begin(), 151);
  const auto again = replay_run({}, "branch.mcap");
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(again->equal());

  // and once more, from the branch: the push is part of it
  const auto twig = record_branch({path("branch.mcap"), std::nullopt, 155}, path("twig.mcap"));
  ASSERT_TRUE(twig.ok()) << to_string(twig.errors());
  EXPECT_THAT(twig->run.remarks, IsEmpty());
  EXPECT_TRUE(compare(branch, loaded("twig.mcap"), {}).equal);
}

TEST_F(BranchTest, AnotherControllerTakesOverWithTheMemoryOfWhatItWouldHaveDone) {
  record_hinge();
  BranchOptions options;
  options.libraries["C"] = "HingePdChanged";  // commands differently from tick 70 on
  const BranchSummary branch = branched(120, options);
  ASSERT_TRUE(branch.before.first);
  EXPECT_EQ(branch.before.first->tick, 70);
  EXPECT_THAT(branch.run.remarks, IsEmpty()) << "the world is the recorded one";
  const Trace run = loaded("run.mcap"), trace = loaded("branch.mcap");
  const std::vector<double> before = run.values("Rig/SHOULDER/q"), after = trace.values("Rig/SHOULDER/q");
  const auto [then, now] = std::mismatch(before.begin(), before.end(), after.begin());
  EXPECT_GE(then - before.begin(), 121) << "until then the recorded controller moved it";
  EXPECT_LE(then - before.begin(), 123);
  EXPECT_THAT(trace.find_metadata("rehearse.branch")->at("controller.1"), HasSubstr("Rig/C HingePdChanged.so "));

  ReplayOptions with_it;
  with_it.libraries = options.libraries;
  const auto again = replay_run(with_it, "branch.mcap");
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(again->equal()) << to_string(*again->first);

  // the commands that acted on the world are recorded: they alone move it in the same way, from the start and from
  // every checkpoint
  EXPECT_EQ(topics(trace, "/Rig/C/acted/"), std::vector<std::string>{"/Rig/C/acted/joints"});
  expect_plant_repeats("branch.mcap");
  const auto twig = record_branch({path("branch.mcap"), std::nullopt, 150}, path("twig.mcap"), options);
  ASSERT_TRUE(twig.ok()) << to_string(twig.errors());
  EXPECT_THAT(twig->run.remarks, IsEmpty());
  EXPECT_TRUE(compare(trace, loaded("twig.mcap"), {}).equal);
}

TEST_F(BranchTest, AlteredInputsGoOnInTheClosedLoop) {
  record_hinge();
  BranchOptions options;
  options.set = {"Rig/SHOULDER/q+=0.2@tick:110..129"};
  const BranchSummary branch = branched(120, options);
  ASSERT_TRUE(branch.before.first);
  EXPECT_EQ(branch.before.first->tick, 110);
  const Trace run = loaded("run.mcap"), trace = loaded("branch.mcap");
  EXPECT_EQ(trace.at("Rig/SHOULDER/q", 0.115), run.at("Rig/SHOULDER/q", 0.115));
  for (const double time : {0.115, 0.125})
    EXPECT_EQ(trace.at("Rig/C/input/SHOULDER/q", time), trace.at("Rig/SHOULDER/q", time) + 0.2) << time;
  EXPECT_NE(trace.last("Rig/SHOULDER/q"), run.last("Rig/SHOULDER/q"));
  const auto again = replay_run({}, "branch.mcap");
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(again->equal()) << to_string(*again->first);
}

TEST_F(BranchTest, GoesOnLongerThanItsSource) {
  record_hinge();
  BranchOptions options;
  options.until = 0.25;
  EXPECT_EQ(branched(200, options).run.ticks, 250);
  options.until.reset();
  options.duration = 0.01;
  EXPECT_EQ(branched(50, options).run.ticks, 60);
}

TEST_F(BranchTest, WithoutCheckpointsTheWorldComesFromTheStart) {
  RecordOptions none;
  none.checkpoint_period = 0.0;
  const Scenario scenario = load(rig(behaviour("C", "push 1"), "cameras: none\n", "0.1"));
  ASSERT_TRUE(record(scenario, path("run.mcap"), none).ok());
  const BranchSummary branch = branched(60);
  EXPECT_THAT(branch.world, HasSubstr("led from the start to tick 60 by the recorded commands: the recording has no "
                                      "checkpoints"));
  EXPECT_TRUE(compare(loaded("run.mcap"), loaded("branch.mcap"), {}).equal);
}

TEST_F(BranchTest, ARecordingThatWasCutCanBeBranchedBeforeTheCut) {
  record_run(rig(behaviour("C", "push 1"), "cameras: none\n", "3"));
  const std::string whole = bytes("run.mcap");
  write("run.mcap", whole.substr(0, whole.size() * 2 / 3));
  BranchOptions options;
  options.until = 0.7;
  EXPECT_EQ(branched(500, options).run.ticks, 700);
  EXPECT_THAT(refusal(at(2900)), HasSubstr("where it is cut or damaged, before tick 2900"));
}

TEST_F(BranchTest, RefusesWhatMakesNoSense) {
  record_hinge();
  EXPECT_THAT(refusal(at(201)), HasSubstr("its last whole tick is 199 (0.199 s), before tick 201"));
  EXPECT_THAT(refusal(at(200)), HasSubstr("there is nothing to simulate: the branch begins at 0.2 s"));
  EXPECT_THAT(refusal({path("nothing.mcap"), 1.0, std::nullopt}), HasSubstr("nothing.mcap"));
  BranchOptions options;
  options.push = {"Rig/LEG force=0,0,1 @0.1s..0.2s"};
  EXPECT_THAT(refusal(at(50), options), HasSubstr("there is no link 'Rig/LEG'"));
  options.push = {"Rig/ARM force=0,0 @0.1s..0.2s"};
  EXPECT_THAT(refusal(at(50), options), HasSubstr("'force=0,0' is none of force=X,Y,Z"));
  options.push = {"Rig/ARM force=0,0,1"};
  EXPECT_THAT(refusal(at(50), options), HasSubstr("a push lasts for a span"));
  options.push = {"Rig/ARM force=0,0,1 @0.01s..0.2s"};
  EXPECT_THAT(refusal(at(50), options), HasSubstr("before the moment 0.05 s"));
  options.push = {};
  options.set = {"Rig/RAIL/q=1@tick:60"};
  EXPECT_THAT(refusal(at(50), options), HasSubstr("no controller reads 'Rig/RAIL/q'"));
  options.set = {};
  options.libraries["C"] = "NoSuchController";
  EXPECT_THAT(refusal(at(50), options), HasSubstr("NoSuchController"));
  const auto same = record_branch(at(50), path("run.mcap"));
  ASSERT_FALSE(same.ok());
  EXPECT_THAT(to_string(same.errors()), HasSubstr("that is the recording to branch from"));
}

TEST_F(BranchTest, ReadsAMoment) {
  EXPECT_EQ(*BranchPoint::parse("a@b.mcap@3.2s")->time, 3.2);
  EXPECT_EQ(BranchPoint::parse("a@b.mcap@3.2s")->trace, "a@b.mcap");
  EXPECT_EQ(*BranchPoint::parse("a.mcap@tick:640")->tick, 640);
  for (const char* wrong :
       {"a.mcap", "a.mcap@3.2", "a.mcap@tick:1.5", "a.mcap@tick:-1", "a.mcap@-1s", "@1s", "a.mcap@"})
    EXPECT_FALSE(BranchPoint::parse(wrong).ok()) << wrong;
}

}  // namespace
}  // namespace rehearse
