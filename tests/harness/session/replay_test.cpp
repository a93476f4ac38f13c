// Recorded inputs are replayed into controllers, without physics.

#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

class Replay : public RunTest {
 protected:
  /// The wheel, away from its rest position, under HingePd, for 100 ticks.
  static std::string hinge_pd() {
    return "rehearse: 1\nduration: 0.1\ncameras: none\nbodies:\n  - name: Rig\n    model: rig.urdf\n"
           "    joints: {SHOULDER: 0.3}\n    controllers: [{name: C, library: HingePd}]\n";
  }

  ReplayReport replayed(const ReplayOptions& options = {}, const std::string& file = "run.mcap") {
    auto report = replay_run(options, file);
    if (report) return *report;
    ADD_FAILURE() << to_string(report.errors());
    return {};
  }

  /// Records and replays; expects the same bits.
  ReplayReport expect_equal(const std::string& text) {
    record_run(text);
    const ReplayReport report = replayed();
    EXPECT_TRUE(report.equal()) << (report.first ? to_string(*report.first) : to_string(*report.failure));
    EXPECT_EQ(report.ticks, summary_.ticks);
    EXPECT_GE(report.values, report.ticks);
    return report;
  }
};

TEST_F(Replay, GivesTheSameCommandsBitForBit) {
  const ReplayReport report = expect_equal(hinge_pd());
  EXPECT_EQ(report.values, 100 * 2);  // an effort and what control() returned, a tick
  EXPECT_EQ(report.values_different, 0);
  EXPECT_EQ(report.ticks_different, 0);
}

TEST_F(Replay, ComparesCommandedAccelerationsAsOtherNumbers) {
  EXPECT_EQ(expect_equal(rig_with("drive acceleration 1")).values, 20 * 2);
  ReplayOptions options;
  options.controllers["Rig/C"] = {"Behaviours", "drive acceleration 1.5", true, true, {}};
  const ReplayReport report = replayed(options);
  EXPECT_EQ(report.values_different, 20);
  ASSERT_TRUE(report.first.has_value());
  EXPECT_THAT(to_string(*report.first), HasSubstr("/Rig/C/output/joint_accelerations SHOULDER/ddq is 1.5 rad/s²"));
}

TEST_F(Replay, DeliversEveryKindOfNumberBitForBit) {
  expect_equal(rig(behaviour("C", "feel"), "cameras: none\n", "0.2"));
}

TEST_F(Replay, TakesAValueThatNoInputHasFromTheState) {
  const std::vector<double> efforts = record_run(hinge_pd()).values("Rig/SHOULDER/u");
  ReplayOptions options;
  options.libraries["C"] = "HingePdWithEffort";
  const ReplayReport report = replayed(options);
  ASSERT_TRUE(report.first.has_value());
  EXPECT_NE(efforts[report.first->tick], 0.0);
  EXPECT_NEAR(report.first->difference, 0.5 * std::abs(efforts[report.first->tick]), 1e-9);
}

TEST_F(Replay, FindsLinksWhoseNamesHaveSlashes) {
  std::string namespaced = rig_urdf;
  for (std::size_t at = 0; (at = namespaced.find("\"ARM\"", at)) != std::string::npos; at += 6)
    namespaced.replace(at, 5, "\"left/ARM\"");
  namespaced.insert(namespaced.find("<sensor name=\"Gyro\""), "<sensor name=\"head/100%\" type=\"gyroscope\"/>");
  write("rig.urdf", namespaced);
  expect_equal(rig(behaviour("C", "feel"), "cameras: none\n", "0.2"));
  const Trace trace = *Trace::load(path("run.mcap"));
  EXPECT_NE(trace.find_channel("/Rig/C/input/left%2FARM/pose"), nullptr);
  EXPECT_NE(trace.find_channel("/Rig/head%2F100%25/imu"), nullptr);
}

TEST_F(Replay, DeliversPicturesAndPointsBitForBit) {
  expect_equal(rig(behaviour("C", "look"), "", "0.05"));
  const std::vector<double> sums = Trace::load(path("run.mcap"))->values("Rig/C/output/SHOULDER/u");
  EXPECT_NE(sums.front(), sums[6]);  // the picture has changed
  EXPECT_NE(sums[6], sums.back());   // and then something else: the delay and the arm's angle
}

TEST_F(Replay, DeliversThatACameraWasSwitchedOff) {
  expect_equal(rig(behaviour("A", "look") + ", " + behaviour("B", "switch 22 notify"), "", "0.05"));
}

TEST_F(Replay, OfFamiliesAndSeveralBodies) {
  const std::string family = "{name: P, library: Behaviours, options: \"mark 42\", children: [" +
                             behaviour("Child", "read_mark") + "]}, " + behaviour("Sibling", "feel");
  expect_equal(rig(family) +
               "  - name: Box\n    box: {size: [1, 1, 1]}\n    mass: 2\n    position: [9, 0, 0]\n    controllers: [" +
               behaviour("W", "wrench 1 2 3") + "]\n");
}

TEST_F(Replay, FindsAChangedGainAtTheTickInWhichItActs) {
  record_run(hinge_pd());
  ReplayOptions options;
  options.libraries["C"] = "HingePdChanged";  // 1 % more from tick 70 on
  const ReplayReport report = replayed(options);
  EXPECT_FALSE(report.equal());
  ASSERT_TRUE(report.first.has_value());
  EXPECT_EQ(report.first->tick, 70);
  EXPECT_EQ(report.first->time, 0.07);
  EXPECT_EQ(report.first->channel, "/Rig/C/output/joints");
  EXPECT_EQ(report.first->element, "SHOULDER/u");
  EXPECT_EQ(report.first->stage, Stage::controller);
  EXPECT_EQ(report.first->unit, "N·m");
  EXPECT_NEAR(report.first->difference, 0.01 * 50.0 * Trace::load(path("run.mcap"))->values("Rig/SHOULDER/q")[70],
              1e-9);
  EXPECT_GT(report.first->ulps, 0u);
  EXPECT_EQ(report.ticks, 100);  // it continues to the end: nothing amplifies
  EXPECT_EQ(report.ticks_different, 30);
  EXPECT_EQ(report.values_different, 30);
}

TEST_F(Replay, ScalesRelativeTolerancesByTheLargestRecordedCommand) {
  std::string text = hinge_pd();
  text.replace(text.find("0.1"), 3, "0.2");  // the effort passes 0 after tick 70
  const std::vector<double> efforts = record_run(text).values("Rig/C/output/SHOULDER/u");
  const auto [least, greatest] = std::minmax_element(efforts.begin(), efforts.end());
  const double largest = std::max(-*least, *greatest);
  ReplayOptions options;
  options.libraries["C"] = "HingePdChanged";
  ToleranceRule rule;
  rule.channel = "Rig/C/output/*";
  rule.atol = 0.0;
  rule.rtol = 0.01;
  options.tolerances = {rule};
  const ReplayReport report = replayed(options);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->tolerance, 0.01 * largest);
  EXPECT_TRUE(report.within()) << to_string(*report.beyond);
  options.tolerances->front().rtol = 0.001;
  EXPECT_FALSE(replayed(options).within());
}

TEST_F(Replay, ScalesRelativeTolerancesOfAVectorByItsLargestNorm) {
  record_run(
      "rehearse: 1\nduration: 0.02\nbodies:\n  - name: Box\n    box: {size: [1, 1, 1]}\n    mass: 2\n"
      "    position: [9, 0, 0]\n    controllers: [" +
      behaviour("W", "wrench 1 2 3") + "]\n");
  ReplayOptions options;
  options.controllers["Box/W"] = {"Behaviours", "wrench 1.002 2 3", true, false, {}};
  ToleranceRule rule;
  rule.channel = "Box/W/output/*";
  rule.atol = 0.0;
  rule.rtol = 0.001;
  options.tolerances = {rule};
  const ReplayReport report = replayed(options);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->element, "force/x");
  EXPECT_EQ(report.first->tolerance, 0.001 * std::sqrt(14.0));
  EXPECT_TRUE(report.within()) << to_string(*report.beyond);
}

TEST_F(Replay, LabelsNameAControllerToo) {
  record_run(hinge_pd());
  ReplayOptions options;
  options.libraries["Rig/C"] = "HingePdChanged";
  EXPECT_EQ(replayed(options).first->tick, 70);
}

TEST_F(Replay, ComparesBetweenFromAndUntil) {
  record_run(hinge_pd());
  ReplayOptions options;
  options.libraries["C"] = "HingePdChanged";
  options.from = 0.08;
  EXPECT_EQ(replayed(options).first->tick, 80);
  options.from = 0.0;
  options.until = 0.05;
  const ReplayReport early = replayed(options);
  EXPECT_TRUE(early.equal());
  EXPECT_EQ(early.ticks, 50);
}

TEST_F(Replay, RefusesAControllerThatReadsWhatWasNotRecorded) {
  record_run(rig_with("push 1"));
  const std::string trace = bytes("run.mcap");
  ReplayOptions options;
  options.libraries["C"] = "HingePd";  // reads q and dq, which every trace has
  EXPECT_EQ(replayed(options).ticks, 20);

  record_run(rig(behaviour("C", "look"), "record: {frames: false}\n"));
  const auto refused = replay_run();
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.errors()[0].message,
              HasSubstr("controller 'Rig/C' reads device 'Camera', which was not recorded"));
  EXPECT_EQ(refused.errors()[0].hint, "record again with this controller");
  EXPECT_THAT(refused.errors()[0].file, HasSubstr("run.mcap"));
}

TEST_F(Replay, OfACameraThatDidNotRunNeedsNoPictures) { expect_equal(rig(behaviour("C", "look"))); }

TEST_F(Replay, SaysThatACommandIsMissing) {
  record_run(hinge_pd());
  ReplayOptions options;
  options.controllers["Rig/C"] = {"Behaviours", "", true, true, {}};  // without options the controller refuses
  const ReplayReport report = replayed(options);
  ASSERT_TRUE(report.first.has_value());
  EXPECT_EQ(report.first->tick, 0);
  EXPECT_THAT(report.first->note, HasSubstr("no longer commands it"));
}

TEST_F(Replay, ReadsNothingButTheTrace) {
  record_run(hinge_pd());
  std::filesystem::remove(path("run.yaml"));
  std::filesystem::remove(path("rig.urdf"));
  EXPECT_TRUE(replayed().equal());
}

TEST_F(Replay, OfATraceOfSomethingElseIsRefused) {
  auto writer = mcap::Writer::create(path("other.mcap"));
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE((*writer)->close().ok());
  const auto report = replay_run({}, "other.mcap");
  ASSERT_FALSE(report.ok());
  EXPECT_THAT(report.errors()[0].message, HasSubstr("not a recording of Rehearse"));
}

TEST_F(Replay, OfADamagedTraceIsRefused) {
  record_run(hinge_pd());
  std::string damaged = bytes("run.mcap");
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  write("damaged.mcap", damaged);
  const auto refused = replay_run({}, "damaged.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.errors()[0].message, HasSubstr("CRC"));
}

TEST_F(Replay, ReportsItsProgress) {
  record_run(hinge_pd());
  std::int64_t last = 0;
  ReplayOptions options;
  options.progress = [&](std::int64_t done, std::int64_t all) {
    EXPECT_EQ(all, 100);
    EXPECT_EQ(done, last + 1);
    last = done;
  };
  replayed(options);
  EXPECT_EQ(last, 100);
}

}  // namespace
}  // namespace rehearse
