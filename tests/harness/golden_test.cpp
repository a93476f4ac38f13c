#include <rehearse/golden.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "golden_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::EnvironmentVariable;
using testing::GoldenFolder;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::read_file;
using testing::SmallTrace;
using testing::write;

class Golden : public GoldenFolder {
  const EnvironmentVariable ci_{"CI", ""};  // messages advise differently there
};

TEST(GoldenMode, IsCheckUnlessSaidOtherwise) {
  const EnvironmentVariable ci("CI", "");
  const EnvironmentVariable mode("REHEARSE_GOLDEN", "");
  EXPECT_EQ(*golden_mode(), GoldenMode::check);
}

TEST(GoldenMode, KnowsThreeWordsAndNamesThemToWhoeverWritesAnother) {
  const EnvironmentVariable ci("CI", "");
  const EnvironmentVariable mode("REHEARSE_GOLDEN", "update");
  ASSERT_FALSE(golden_mode());
  EXPECT_EQ(to_string(golden_mode().errors()[0]),
            "error: REHEARSE_GOLDEN is 'update' (it may be check, new or accept)");
  setenv("REHEARSE_GOLDEN", "new", 1);
  EXPECT_EQ(*golden_mode(), GoldenMode::create);
  setenv("REHEARSE_GOLDEN", "accept", 1);
  EXPECT_EQ(*golden_mode(), GoldenMode::accept);
}

TEST(GoldenMode, IsNothingButCheckUnderCi) {
  const EnvironmentVariable ci("CI", "true");
  const EnvironmentVariable mode("REHEARSE_GOLDEN", "accept");
  ASSERT_FALSE(golden_mode());
  EXPECT_THAT(golden_mode().errors()[0].message, HasSubstr("CI"));
  setenv("REHEARSE_GOLDEN", "new", 1);
  EXPECT_FALSE(golden_mode());
  setenv("REHEARSE_GOLDEN", "check", 1);
  EXPECT_TRUE(golden_mode());
}

TEST_F(Golden, ThatIsMissingFailsAndSaysHowToMakeIt) {
  const GoldenResult result = settle(SmallTrace());
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("REHEARSE_GOLDEN=new"));
  EXPECT_THAT(result.message, HasSubstr("rehearse golden accept " + name_));
  EXPECT_FALSE(store_.has(name_));
}

TEST_F(Golden, IsWrittenWithItsDigestInModeNew) {
  const GoldenResult result = settle(SmallTrace(), GoldenMode::create);
  EXPECT_TRUE(result.passed) << result.message;
  EXPECT_TRUE(result.written);
  EXPECT_TRUE(is_run(SmallTrace()));
  EXPECT_TRUE(store_.check_digest(name_));
}

TEST_F(Golden, IsComparedUpToAHorizonAndSaysSo) {
  place_golden(SmallTrace());
  SettleOptions options;
  options.compare.until = 0.0005;
  const GoldenResult result = settle(changed(), GoldenMode::check, options);
  EXPECT_TRUE(result.passed) << result.message;
  EXPECT_THAT(result.message, HasSubstr("up to 0.0005 s equal bit for bit: 1 tick"));
}

TEST_F(Golden, OfTheSameNumbersFailsOnOtherBitsIfExact) {
  place_golden(SmallTrace());
  SmallTrace run;
  run.ticks[1].position[1] = -0.0;
  SettleOptions options;
  options.exact = true;
  const GoldenResult result = settle(run, GoldenMode::check, options);
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("not the same bits: within tolerance: 1 of "));
}

TEST_F(Golden, DoesNotExcuseARunThatIsWrongByItself) {
  place_golden(SmallTrace());
  SettleOptions options;
  options.violation = "expected it to stand";
  const GoldenResult result = settle(SmallTrace(), GoldenMode::check, options);
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("expected it to stand; equal bit for bit: 3 ticks"));
  EXPECT_TRUE(fs::exists(store_.pending_file(name_)));
}

TEST_F(Golden, IsNeverMadeOfARunThatIsWrongByItself) {
  SettleOptions options;
  options.violation = "expected it to stand";
  EXPECT_FALSE(settle(changed(), GoldenMode::create, options).passed);
  EXPECT_FALSE(store_.has(name_));
  place_golden(SmallTrace());
  const std::string before = read_file(store_.trace_file(name_));
  EXPECT_FALSE(settle(changed(), GoldenMode::accept, options).passed);
  EXPECT_EQ(read_file(store_.trace_file(name_)), before);
}

TEST_F(Golden, ThatIsThereIsCheckedInModeNew) {
  place_golden(SmallTrace());
  const std::string before = read_file(store_.trace_file(name_));
  EXPECT_FALSE(settle(changed(), GoldenMode::create).passed);
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == before);
}

TEST_F(Golden, PassesTheSameRun) {
  place_golden(SmallTrace());
  const GoldenResult result = settle(SmallTrace());
  EXPECT_TRUE(result.passed) << result.message;
  EXPECT_TRUE(result.comparison->equal);
  EXPECT_FALSE(result.written);
}

TEST_F(Golden, OfAnotherRunFailsAndIsNotTouched) {
  place_golden(SmallTrace());
  const std::string before = read_file(store_.trace_file(name_));
  const GoldenResult result = settle(changed());
  EXPECT_FALSE(result.passed);
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == before);
  EXPECT_TRUE(read_file(store_.pending_file(name_)) == read_file(folder_ / "run.mcap"));
  EXPECT_THAT(result.message,
              HasSubstr("differs: Robot/Pd/output/KNEE/u is beyond ±0.001 N·m from tick 1 (0.001 s) on"));
  EXPECT_THAT(result.message, HasSubstr("if it is right: rehearse golden accept " + name_));
}

TEST_F(Golden, IsReplacedInModeAcceptAndSaysWhatMoved) {
  place_golden(SmallTrace());
  const GoldenResult result = settle(changed(), GoldenMode::accept);
  EXPECT_TRUE(result.passed) << result.message;
  EXPECT_THAT(result.message, HasSubstr("KNEE/u is beyond ±0.001 N·m from tick 1 (0.001 s) on, worst 87 N·m"));
  EXPECT_TRUE(is_run(changed()));
  EXPECT_TRUE(store_.check_digest(name_));
}

TEST_F(Golden, TakesThePlaceOfTheOldOneWhenThePendingTraceIsAccepted) {
  place_golden(SmallTrace());
  ASSERT_FALSE(settle(changed()).passed);
  const auto moved = store_.accept_pending(name_);
  ASSERT_TRUE(moved) << to_string(moved.errors());
  ASSERT_TRUE(moved->moved.has_value());
  EXPECT_EQ(moved->moved->first->element, "KNEE/u");
  EXPECT_FALSE(fs::exists(store_.pending_file(name_)));
  EXPECT_TRUE(store_.check_digest(name_));
  EXPECT_TRUE(settle(changed()).passed);
}

TEST_F(Golden, ShowsWhatPicturesDifferUntilTheRunIsAcceptedOrRight) {
  const fs::path picture = folder_ / "pending" / (name_ + ".Robot.Eye.image.png");
  SmallTrace other;
  other.ticks[1].image.pixels[0] = 200;
  place_golden(SmallTrace());
  const GoldenResult result = settle(other);
  EXPECT_THAT(result.message, HasSubstr("expected, actual and difference: " + picture.string()));
  EXPECT_TRUE(fs::exists(picture));
  ASSERT_TRUE(store_.accept_pending(name_));
  EXPECT_FALSE(fs::exists(picture));
}

TEST_F(Golden, CanNotBeAcceptedIfNothingWaits) {
  ASSERT_FALSE(store_.accept_pending(name_));
  EXPECT_THAT(store_.accept_pending(name_).errors()[0].message, HasSubstr("nothing waits to be accepted"));
}

TEST_F(Golden, IsNoRunThatFailed) {
  SmallTrace run;
  run.outcome["failure"] = "controller 'Robot/Pd' crashed";
  const GoldenResult result = settle(run, GoldenMode::create);
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("crashed"));
  EXPECT_FALSE(store_.has(name_));
}

TEST_F(Golden, ClaimedTwiceWithOtherContentFails) {
  place_golden(SmallTrace());
  EXPECT_TRUE(settle(SmallTrace()).passed);
  EXPECT_TRUE(settle(SmallTrace()).passed);
  const GoldenResult result = settle(changed());
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("claimed before by another recording"));
}

TEST_F(Golden, WithADigestThatDescribesSomethingElseFails) {
  place_golden(SmallTrace());
  write(store_.digest_file(name_), read_file(store_.digest_file(name_)) + "\n");
  const GoldenResult result = settle(SmallTrace());
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("the digest doesn't describe"));
}

TEST_F(Golden, WithoutADigestFails) {
  place_golden(SmallTrace());
  fs::remove(store_.digest_file(name_));
  EXPECT_THAT(settle(SmallTrace()).message, HasSubstr("is missing"));
}

TEST_F(Golden, ThatIsCutShortIsNoGoldenAndSaysSo) {
  place_golden(SmallTrace());
  fs::resize_file(store_.trace_file(name_), fs::file_size(store_.trace_file(name_)) / 2);
  const GoldenResult result = settle(SmallTrace());
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("the golden can't be used"));
  EXPECT_THAT(result.message, HasSubstr("truncated"));
}

TEST_F(Golden, TheFirstOfAProjectMakesTheirFolder) {
  fs::remove(folder_ / "golden");
  ASSERT_TRUE(settle(SmallTrace(), GoldenMode::create).passed);
  EXPECT_TRUE(fs::exists(store_.trace_file(name_)));
  EXPECT_TRUE(fs::exists(store_.digest_file(name_)));
}

TEST_F(Golden, InAFolderThatIsNoneSaysSo) {
  std::ofstream(folder_ / "nowhere") << "a file";
  GoldenStore nowhere(folder_ / "nowhere", folder_ / "pending");
  const GoldenResult result = nowhere.settle(name_, SmallTrace().load(folder_ / "run.mcap"), {}, GoldenMode::create);
  EXPECT_FALSE(result.passed);
  EXPECT_THAT(result.message, HasSubstr("can't be written"));
}

TEST_F(Golden, DigestStatesEachSeriesForAReader) {
  SmallTrace run;
  run.ticks[1].u = -3.5;
  run.ticks[2].u = std::numeric_limits<double>::quiet_NaN();
  const auto digest = digest_of(run.load(folder_ / "run.mcap"));
  ASSERT_TRUE(digest);
  EXPECT_THAT(*digest, HasSubstr("  KNEE/u [N·m] first 12 last nan min nan max nan NaN 1 times\n"));
  EXPECT_THAT(*digest, HasSubstr("  KNEE/q [rad] first 0.5 last 0.5 min 0.5 max 0.5\n"));
  EXPECT_THAT(*digest, HasSubstr("/Robot/Eye/image sensor_msgs/msg/CompressedImage: 3 pictures\n"));
  EXPECT_THAT(*digest, HasSubstr("  rehearse: 0.1.0\n"));
}

TEST_F(Golden, DigestTellsAllBeamsOfAScanInOneLine) {
  SmallTrace run;
  run.ticks[1].ranges = {0.25F, 2.0F, 2.0F};
  const auto digest = digest_of(run.load(folder_ / "run.mcap"));
  ASSERT_TRUE(digest);
  EXPECT_THAT(*digest, HasSubstr("  ranges of 3 beams [m] min 0.25 max 2, nothing 2 times\n"));
  EXPECT_THAT(*digest, Not(HasSubstr("ranges/")));
}

TEST_F(Golden, DigestTellsAllContactsOfALinkInOneLine) {
  SmallTrace run;
  const auto contact = [](double force, double depth) { return msg::Contact{{}, {}, {0, 0, force}, {}, depth}; };
  run.ticks[0].contacts.emplace();
  run.ticks[1].contacts = {contact(7, 0.001), contact(-20, 0.002)};
  run.ticks[2].contacts = {contact(10, 0.003)};
  const auto digest = digest_of(run.load(folder_ / "run.mcap"));
  ASSERT_TRUE(digest);
  EXPECT_THAT(*digest, HasSubstr("  contacts/count [-] first 0 last 1 min 0 max 2\n"
                                 "  at a point at most 20 N along an axis, 0.003 m deep\n"));
  EXPECT_THAT(*digest, Not(HasSubstr("contacts/0")));
}

TEST_F(Golden, DigestChangesWithASinglePixel) {
  SmallTrace run;
  const auto before = digest_of(run.load(folder_ / "run.mcap"));
  run.ticks[1].image.pixels[5] ^= 1;
  const auto after = digest_of(run.load(folder_ / "run.mcap"));
  EXPECT_NE(*before, *after);
}

TEST_F(Golden, FolderIsTheNearestOneAboveTheScenario) {
  const EnvironmentVariable unset("REHEARSE_GOLDEN_DIR", "");
  fs::create_directories(folder_ / "a/b");
  const auto found = find_golden_folder(folder_ / "a/b/run.yaml");
  ASSERT_TRUE(found);
  EXPECT_TRUE(fs::equivalent(*found, folder_ / "golden"));
  fs::create_directories(folder_ / "a/golden");
  EXPECT_TRUE(fs::equivalent(*find_golden_folder(folder_ / "a/b/run.yaml"), folder_ / "a/golden"));
  setenv("REHEARSE_GOLDEN_DIR", "elsewhere", 1);
  EXPECT_EQ(*find_golden_folder(folder_ / "a/b/run.yaml"), fs::path("elsewhere"));
}

}  // namespace
}  // namespace rehearse
