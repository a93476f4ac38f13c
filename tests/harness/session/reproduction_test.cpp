// Whether a recording repeats itself, and goldens that are matched only by chance.
#include <rehearse/check.h>
#include <rehearse/session.h>

#include <cstring>

#include "mutilate.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const Simulation simulation{record, run_plant};

class Reproduces : public RunTest {
 protected:
  /// 0.55 s of a sled that oscillates: checkpoints at ticks 0, 100, ... 500, and a camera.
  static std::string swinging() { return rig("{name: Pd, library: HingePd}", "", "0.55"); }
  static std::string by_chance() { return rig(behaviour("C", "chance 1e-12"), "cameras: none\n", "0.25"); }

  Reproduction tried(const std::string& scenario, const Trace& recording, int spans = 5) {
    ReproductionOptions options;
    options.spans = spans;
    auto result = reproduce(load(scenario), recording, path("again.mcap"), options, simulation);
    if (result) return *std::move(result);
    ADD_FAILURE() << to_string(result.errors());
    return {};
  }

  Trace changed(const std::string& file, const testing::Mutilation& change) {
    const auto done = testing::mutilate(path(file), change);
    EXPECT_TRUE(done.ok()) << to_string(done.errors());
    return *Trace::load(path(file));
  }

  /// Flips the lowest bit of the last double of the first message on that topic from that time on [ns].
  static testing::Mutilation flipped(const std::string& topic, std::uint64_t from) {
    return [=, done = false](const mcap::Message& message) mutable {
      auto bytes = *testing::untouched(message);
      if (!done && message.channel->topic == topic && message.log_time >= from) {
        bytes[bytes.size() - sizeof(double)] ^= std::byte{1};
        done = true;
      }
      return std::optional(bytes);
    };
  }

  /// A check against run.mcap.
  CheckReport checked(const std::string& scenario) {
    auto report = check_scenario(load(scenario), path("run.mcap"), path("actual.mcap"), {}, simulation);
    if (report) return *std::move(report);
    ADD_FAILURE() << to_string(report.errors());
    return {};
  }
};

TEST_F(Reproduces, WhatItRecorded) {
  const Trace recording = record_run(swinging());
  const Reproduction result = tried(swinging(), recording);
  EXPECT_TRUE(result.reproduced()) << result.verdict;
  EXPECT_EQ(result.replayed, 550);
  EXPECT_EQ(result.spans, 5);
  EXPECT_EQ(result.simulated, 450) << "four tenths of a second and the rest after the last checkpoint";
  EXPECT_THAT(result.verdict, StartsWith("the recording repeats itself, bit for bit: the commands of 550 ticks"));
  EXPECT_FALSE(std::filesystem::exists(path("again.mcap")));
}

TEST_F(Reproduces, TheFirstSpanAloneIfNoMoreIsWanted) {
  EXPECT_EQ(tried(swinging(), record_run(swinging()), 1).simulated, 100);
}

TEST_F(Reproduces, TheWholeRunIfItHasNoCheckpoints) {
  record_run(swinging());
  const Trace recording = changed("run.mcap", [](const mcap::Message& message) {
    return message.channel->topic == "/checkpoint" ? std::nullopt : testing::untouched(message);
  });
  const Reproduction result = tried(swinging(), recording);
  EXPECT_TRUE(result.reproduced()) << result.verdict;
  EXPECT_EQ(result.simulated, 550);
}

TEST_F(Reproduces, ARunThatTheWorldRemarkedOnBeforeACheckpoint) {
  std::string robot = rig_urdf;
  robot.replace(robot.find("upper=\"100\""), 11, "upper=\"0.1\"");
  write("rig.urdf", robot);
  std::string scenario = rig("{name: Pd, library: HingePd}", "cameras: none\n", "0.3");
  scenario.replace(scenario.find("    model: rig.urdf"), 19, "    joint_limits: false\n    model: rig.urdf");
  const Trace recording = record_run(scenario);
  ASSERT_THAT(said(recording), ::testing::Contains(HasSubstr("beyond its limits")));
  const Reproduction result = tried(scenario, recording);
  EXPECT_TRUE(result.reproduced()) << result.verdict;
  EXPECT_EQ(result.spans, 3) << "a span that begins at a checkpoint makes the remark once more";
}

TEST_F(Reproduces, NoCommandThatTheControllerDoesNotGive) {
  record_run(swinging());
  const Trace recording = changed("run.mcap", flipped("/Rig/Pd/output/joints", 300'000'000));
  const Reproduction result = tried(swinging(), recording);
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->stage, Stage::controller);
  EXPECT_EQ(result.first->tick, 300);
  EXPECT_THAT(result.verdict, HasSubstr("fed with its inputs, the controller differs at tick 300"));
}

TEST_F(Reproduces, NoStateThatTheWorldDoesNotReach) {
  record_run(swinging());
  const Trace recording = changed("run.mcap", flipped("/Rig/joints", 520'000'000));
  const Reproduction result = tried(swinging(), recording);
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->stage, Stage::physics);
  EXPECT_EQ(result.first->tick, 520);
  EXPECT_THAT(result.verdict, HasSubstr("under its commands, the world differs at tick 520 (0.52 s): /Rig/joints"));
}

TEST_F(Reproduces, NoStateAfterTheLastTickThatTheWorldDoesNotReach) {
  record_run(swinging());
  const Reproduction result = tried(swinging(), changed("run.mcap", flipped("/Rig/joints", 550'000'000)));
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->channel, "/Rig/joints");
  EXPECT_EQ(result.first->tick, 550);
}

TEST_F(Reproduces, NoPictureThatTheCameraDoesNotTake) {
  record_run(swinging());
  const std::vector<std::string> pictures = topics(*Trace::load(path("run.mcap")), "/Rig/Camera/depth");
  ASSERT_FALSE(pictures.empty());
  const Trace recording = changed("run.mcap", flipped(pictures.front(), 530'000'000));
  const Reproduction result = tried(swinging(), recording);
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->stage, Stage::renderer);
  EXPECT_THAT(result.first->note, StartsWith("1 of 192 pixels (0.521 %) differ"));
}

TEST_F(Reproduces, NoControllerThatGoesByChance) {
  const Trace recording = record_run(by_chance());
  const Reproduction result = tried(by_chance(), recording);
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->tick, 0);
  EXPECT_THAT(result.verdict, HasSubstr("`rehearse audit` finds"));
}

TEST_F(Reproduces, SaysHowAControllerFails) {
  record_run(rig_with("fail throw control 7"));
  EXPECT_THAT(tried(rig_with("fail throw control 7"), *Trace::load(path("run.mcap"))).verdict,
              StartsWith("the recording doesn't repeat itself: "));
}

using CheckCertifies = Reproduces;

TEST_F(CheckCertifies, AGoldenThatIsReproduced) {
  record_run(swinging());
  const CheckReport report = checked(swinging());
  EXPECT_TRUE(report.equal()) << report.verdict.text();
  EXPECT_FALSE(report.not_reproduced);
}

TEST_F(CheckCertifies, NoGoldenThatIsMetByChance) {
  record_run(by_chance());
  const CheckReport report = checked(by_chance());
  ASSERT_TRUE(report.comparison.has_value());
  EXPECT_TRUE(report.comparison->within) << "the tolerances alone would have let it pass";
  EXPECT_TRUE(report.not_reproduced);
  EXPECT_THAT(to_json(report), HasSubstr("\"not_reproduced\": true"));
  EXPECT_FALSE(report.within());
  EXPECT_THAT(report.verdict.text(),
              StartsWith("the golden isn't certified, though this run is within its tolerances: the "
                         "recording doesn't repeat itself"));
}

TEST_F(CheckCertifies, NoGoldenThatTheVerySameProgramsDoNotMake) {
  record_run(swinging());
  changed("run.mcap", flipped("/Rig/joints", 520'000'000));
  const CheckReport report = checked(swinging());
  ASSERT_TRUE(report.comparison.has_value());
  EXPECT_TRUE(report.comparison->within);
  EXPECT_TRUE(report.comparison->same_origin);
  EXPECT_TRUE(report.not_reproduced);
  EXPECT_THAT(report.verdict.text(), HasSubstr("it states the same programs, files and controllers"));
  EXPECT_EQ(report.first->tick, 520);
}

TEST_F(CheckCertifies, AGoldenOfOtherProgramsWithinItsTolerances) {
  record_run(swinging());
  ASSERT_TRUE(
      testing::mutilate(path("run.mcap"), flipped("/Rig/joints", 520'000'000), {}, {{"programs", "others"}}).ok());
  const CheckReport report = checked(swinging());
  EXPECT_FALSE(report.comparison->same_origin);
  EXPECT_TRUE(report.within()) << report.verdict.text();
  EXPECT_FALSE(report.equal());
}

}  // namespace
}  // namespace rehearse
