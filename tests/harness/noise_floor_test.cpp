#include "core/check/noise_floor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "small_traces.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SmallTrace;
using testing::TemporaryFolder;

/// Three ticks of a recording with provenance, and a noise measurement of it.
class NoiseFloorTest : public ::testing::Test {
 protected:
  NoiseFloorTest() {
    small_.provenance["physics"] = "ODE 0.16.2";
    golden_ = small_.load(folder_ / "Box.Falls.mcap");
    noise_.scenario = "box";
    noise_.recording = hash_of_recording(golden_);
    noise_.duration = 0.003;
    noise_.made_with = {{"physics", "ODE 0.16.2"}, {"processor", "of: this machine"}};
    noise_.perturbations = {{"last bits, pattern 1", "", false, true, true, 1.25, std::nullopt},
                            {"last bits, pattern 2", "", false, true, true, 0.5, std::nullopt},
                            {"renderer of SSE2", "no camera of the scenario runs", false, true, false, {}, {}}};
    noise_.channels = {{"/Robot/joints", "rad", std::nullopt, 3.0e-15, 1e-9},
                       {"/Robot/Pd/output/joints", "N·m", 2.0e-13, std::nullopt, 1e-4}};
    noise_.growth = 1234.0;
  }

  std::vector<std::string> remarks(const std::vector<ToleranceRule>& rules = {}) const {
    const Comparison comparison = compare(golden_, golden_, rules);
    return noise_remarks(noise_, golden_, {&comparison});
  }
  static std::vector<ToleranceRule> everything(double atol) {
    ToleranceRule rule;
    rule.channel = "*";
    rule.atol = atol;
    return {rule};
  }

  TemporaryFolder folder_;
  SmallTrace small_;
  Trace golden_;
  NoiseFloor noise_;
};

TEST_F(NoiseFloorTest, ComesBackFromItsFile) {
  const fs::path file = noise_file_of(folder_ / "Box.Falls.mcap");
  EXPECT_EQ(file.filename(), "Box.Falls.noise");
  ASSERT_TRUE(write_noise_floor(noise_, file));
  const auto read = load_noise_floor(file);
  ASSERT_TRUE(read) << to_string(read.errors());
  EXPECT_EQ(to_yaml(*read), to_yaml(noise_));
  EXPECT_EQ(read->recording, noise_.recording);
  EXPECT_EQ(read->made_with, noise_.made_with);
  ASSERT_EQ(read->channels.size(), 2u);
  EXPECT_EQ(read->channels[0].plant, 3.0e-15);
  EXPECT_FALSE(read->channels[0].controller);
  EXPECT_EQ(read->channels[1].unit, "N·m");
  EXPECT_EQ(read->perturbations[2].not_made, "no camera of the scenario runs");
  EXPECT_TRUE(read->perturbations[0].plant && read->perturbations[0].closed && !read->perturbations[0].controller);
  EXPECT_FALSE(fs::exists(file.string() + ".new"));
}

TEST_F(NoiseFloorTest, HasTheEarliestHorizonOfAllPerturbations) {
  EXPECT_EQ(noise_.horizon(), 0.5);
  noise_.perturbations.resize(1);
  noise_.perturbations[0].horizon.reset();
  EXPECT_EQ(noise_.horizon(), std::nullopt);
}

TEST_F(NoiseFloorTest, EstimatesTheHorizonOfItsOwnGoldenOnly) {
  EXPECT_EQ(estimated_horizon(golden_), std::nullopt);
  ASSERT_TRUE(write_noise_floor(noise_, noise_file_of(golden_.file())));
  EXPECT_EQ(estimated_horizon(golden_), 0.8 * 0.5);
  noise_.recording = "0000000000000000";
  ASSERT_TRUE(write_noise_floor(noise_, noise_file_of(golden_.file())));
  EXPECT_EQ(estimated_horizon(golden_), std::nullopt);
}

TEST_F(NoiseFloorTest, KeepsTheOldFileIfTheNewOneCannotBeWritten) {
  const fs::path file = folder_ / "Box.Falls.noise";
  ASSERT_TRUE(write_noise_floor(noise_, file));
  fs::create_directory(file.string() + ".new");  // where the draft would be
  noise_.scenario = "another";
  EXPECT_FALSE(write_noise_floor(noise_, file));
  EXPECT_EQ(load_noise_floor(file)->scenario, "box");
}

TEST_F(NoiseFloorTest, TellsSmallDifferencesFromOthers) {
  small_.ticks[1].q = std::nextafter(0.5, 1.0);
  const Trace run = small_.load(folder_ / "run.mcap");
  CompareOptions options;
  options.noise_floors = noise_of_series(noise_, golden_);
  options.stages = {Stage::physics};
  EXPECT_EQ(options.noise_floors.at("Robot/KNEE/q"), 3.0e-15);
  EXPECT_EQ(compare(golden_, run, {}, options).in_noise, 1);
  EXPECT_THAT(noise_of_series(noise_, run), IsEmpty()) << "that of another golden says nothing";
}

TEST_F(NoiseFloorTest, GoesWithItsGolden) {
  GoldenStore store(folder_ / "golden", folder_ / "pending");
  ASSERT_TRUE(store.accept("Box.Falls", golden_.file()));
  const fs::path file = noise_file_of(store.trace_file("Box.Falls"));
  ASSERT_TRUE(write_noise_floor(noise_, file));
  ASSERT_TRUE(store.remove("Box.Falls"));
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(NoiseFloorTest, SaysNothingOfTolerancesAboveIt) { EXPECT_THAT(remarks(), IsEmpty()); }

TEST_F(NoiseFloorTest, TellsTolerancesBelowIt) {
  EXPECT_THAT(
      remarks(everything(1e-15)),
      ElementsAre("2 tolerances lie below the measured noise, the most in /Robot/Pd/output/joints [N·m]: 1e-15 is "
                  "allowed, 2e-13 is noise"));
}

TEST_F(NoiseFloorTest, TellsTolerancesFarAboveIt) {
  EXPECT_THAT(
      remarks(everything(1e-5)),
      ElementsAre("1 tolerance lies more than 1e+09 times above the measured noise, the most in /Robot/joints [rad]: "
                  "1e-05 is allowed, 3e-15 is the noise of its unit"));
}

TEST_F(NoiseFloorTest, TellsThatItWasMeasuredWithAnotherVersion) {
  noise_.made_with["physics"] = "ODE 0.16.4";
  EXPECT_THAT(remarks(), ElementsAre("the noise was measured with physics \"ODE 0.16.4\", the golden recorded with "
                                     "\"ODE 0.16.2\"; measure it again: rehearse golden noise"));
}

TEST_F(NoiseFloorTest, TellsThatItIsOfAnotherRecording) {
  small_.ticks[1].q = 0.6;
  golden_ = small_.load(folder_ / "other.mcap");
  EXPECT_THAT(remarks(), ElementsAre(HasSubstr("for a different recording than this golden")));
}

TEST_F(NoiseFloorTest, OnAnotherProcessorIsTheSame) {
  noise_.made_with["processor"] = "another";
  EXPECT_THAT(remarks(), IsEmpty());
}

TEST(BrokenNoiseFloor, IsAnsweredAtItsPlace) {
  const auto answer = [](const std::string& name) {
    const auto read = load_noise_floor(fs::path(FIXTURES_DIR) / "broken" / (name + ".noise"));
    return read ? "it was read" : to_string(read.errors());
  };
  EXPECT_THAT(answer("noise_without_recording"), HasSubstr("noise_without_recording.noise:1:1: error: "));
  EXPECT_THAT(answer("noise_without_recording"), HasSubstr("recording"));
  EXPECT_THAT(answer("noise_of_another_version"), HasSubstr("noise_of_another_version.noise:1:8: error: "));
  EXPECT_THAT(answer("noise_negative"), HasSubstr("noise_negative.noise:5:46: error: "));
  EXPECT_THAT(answer("noise_of_an_unknown_level"), HasSubstr("noise_of_an_unknown_level.noise:4:32: error: "));
  EXPECT_THAT(answer("noise_that_isnt_there"), HasSubstr("noise_that_isnt_there.noise"));
}

}  // namespace
}  // namespace rehearse
