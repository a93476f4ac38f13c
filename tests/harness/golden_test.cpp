#include <rehearse/golden.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "small_traces.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SmallTrace;
using testing::TemporaryFolder;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

/// A variable for the length of a test.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* was = std::getenv(name)) was_ = was;
    setenv(name, value, 1);
  }
  ~Environment() { was_ ? setenv(name_, was_->c_str(), 1) : unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::optional<std::string> was_;
};

class Golden : public ::testing::Test {
 protected:
  Golden() : store_(folder_ / "golden", folder_ / "pending") { fs::create_directories(folder_ / "golden"); }

  GoldenResult settle(const SmallTrace& run, GoldenMode mode = GoldenMode::check, const SettleOptions& options = {}) {
    return store_.settle(name_, run.load(folder_ / "run.mcap"), {}, mode, options);
  }
  /// Puts a golden there without claiming it for this process.
  void place_golden(const SmallTrace& run) {
    run.write(folder_ / "accepted.mcap");
    const auto accepted = store_.accept(name_, folder_ / "accepted.mcap");
    ASSERT_TRUE(accepted) << to_string(accepted.errors());
  }
  SmallTrace changed() const {
    SmallTrace run;
    run.ticks[1].u = 99.0;
    return run;
  }

  TemporaryFolder folder_;
  GoldenStore store_;
  std::string name_ = std::string("Golden.") + ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST(GoldenMode, IsCheckUnlessSaidOtherwise) {
  const Environment ci("CI", "");
  const Environment mode("REHEARSE_GOLDEN", "");
  EXPECT_EQ(*golden_mode(), GoldenMode::check);
}

TEST(GoldenMode, KnowsThreeWordsAndNamesThemToWhoeverWritesAnother) {
  const Environment ci("CI", "");
  const Environment mode("REHEARSE_GOLDEN", "update");
  ASSERT_FALSE(golden_mode());
  EXPECT_EQ(to_string(golden_mode().errors()[0]),
            "error: REHEARSE_GOLDEN is 'update' (it may be check, new or accept)");
  setenv("REHEARSE_GOLDEN", "new", 1);
  EXPECT_EQ(*golden_mode(), GoldenMode::create);
  setenv("REHEARSE_GOLDEN", "accept", 1);
  EXPECT_EQ(*golden_mode(), GoldenMode::accept);
}

TEST(GoldenMode, IsNothingButCheckUnderCi) {
  const Environment ci("CI", "true");
  const Environment mode("REHEARSE_GOLDEN", "accept");
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
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), bytes_of(folder_ / "run.mcap"));
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
  const std::string before = bytes_of(store_.trace_file(name_));
  EXPECT_FALSE(settle(changed(), GoldenMode::accept, options).passed);
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), before);
}

TEST_F(Golden, ThatIsThereIsCheckedInModeNew) {
  place_golden(SmallTrace());
  const std::string before = bytes_of(store_.trace_file(name_));
  EXPECT_FALSE(settle(changed(), GoldenMode::create).passed);
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), before);
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
  const std::string before = bytes_of(store_.trace_file(name_));
  const GoldenResult result = settle(changed());
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), before);
  EXPECT_EQ(bytes_of(store_.pending_file(name_)), bytes_of(folder_ / "run.mcap"));
  EXPECT_THAT(result.message, HasSubstr("differs at tick 1 (0.001 s): /Robot/Pd/output/joints KNEE/u"));
  EXPECT_THAT(result.message, HasSubstr("if it is right: rehearse golden accept " + name_));
}

TEST_F(Golden, IsReplacedInModeAcceptAndSaysWhatMoved) {
  place_golden(SmallTrace());
  const GoldenResult result = settle(changed(), GoldenMode::accept);
  EXPECT_TRUE(result.passed) << result.message;
  EXPECT_THAT(result.message, HasSubstr("KNEE/u is 99"));
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), bytes_of(folder_ / "run.mcap"));
  EXPECT_TRUE(store_.check_digest(name_));
}

TEST_F(Golden, TakesThePlaceOfTheOldOneWhenThePendingTraceIsAccepted) {
  place_golden(SmallTrace());
  ASSERT_FALSE(settle(changed()).passed);
  const auto moved = store_.accept_pending(name_);
  ASSERT_TRUE(moved) << to_string(moved.errors());
  ASSERT_TRUE(moved->has_value());
  EXPECT_EQ((*moved)->first->element, "KNEE/u");
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
  write(store_.digest_file(name_), bytes_of(store_.digest_file(name_)) + "\n");
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

TEST_F(Golden, SurvivesADiskThatIsFull) {
  place_golden(SmallTrace());
  const std::string trace = bytes_of(store_.trace_file(name_)), digest = bytes_of(store_.digest_file(name_));
  changed().write(folder_ / "run.mcap");
  rlimit unlimited_size{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited_size), 0);
  const rlimit full{1000, unlimited_size.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  const auto accepted = store_.accept(name_, folder_ / "run.mcap");
  setrlimit(RLIMIT_FSIZE, &unlimited_size);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(accepted);
  EXPECT_EQ(bytes_of(store_.trace_file(name_)), trace);
  EXPECT_EQ(bytes_of(store_.digest_file(name_)), digest);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "golden"), fs::directory_iterator()), 2);
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
  EXPECT_THAT(*digest, HasSubstr("/Robot/Eye/image sensor_msgs/msg/CompressedImage: 3 pictures, hash "));
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
  const Environment unset("REHEARSE_GOLDEN_DIR", "");
  fs::create_directories(folder_ / "a/b");
  const auto found = find_golden_folder(folder_ / "a/b/run.yaml");
  ASSERT_TRUE(found);
  EXPECT_TRUE(fs::equivalent(*found, folder_ / "golden"));
  fs::create_directories(folder_ / "a/golden");
  EXPECT_TRUE(fs::equivalent(*find_golden_folder(folder_ / "a/b/run.yaml"), folder_ / "a/golden"));
  setenv("REHEARSE_GOLDEN_DIR", "elsewhere", 1);
  EXPECT_EQ(*find_golden_folder(folder_ / "a/b/run.yaml"), fs::path("elsewhere"));
}

TEST_F(Golden, ListKnowsOwnersOrphansAndWhatWaits) {
  name_ = "Walker.Walks";
  place_golden(SmallTrace());
  name_ = "Walker.Stops";
  place_golden(SmallTrace());
  name_ = "Walker.Forgotten";
  place_golden(SmallTrace());
  write(folder_ / "golden/Walker.Lost.txt", "digest");
  fs::create_directories(folder_ / "pending");
  write(store_.pending_file("Walker.Stops"), "waits");
  write(folder_ / "walk.yaml", "rehearse: 1\ngolden: Walker.Walks   # the golden\n");
  write(folder_ / "stop_test.cpp", "TEST_F(Walker,\n       Stops) { EXPECT_MATCHES_GOLDEN(trace); }\n");
  write(folder_ / "other_test.cpp", "TEST(Walker, Forgotten) { EXPECT_TRUE(true); }\n");

  const auto listed = list_goldens(store_, {folder_.path()});
  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 4u);
  const GoldenEntry &forgotten = (*listed)[0], &lost = (*listed)[1], &stops = (*listed)[2], &walks = (*listed)[3];
  EXPECT_EQ(forgotten.name, "Walker.Forgotten");
  EXPECT_TRUE(forgotten.orphan());
  EXPECT_EQ(forgotten.problem, "");
  EXPECT_EQ(forgotten.recorded_by, "rehearse 0.1.0");
  EXPECT_EQ(lost.problem, "there is a digest, but no recording");
  EXPECT_THAT(stops.owners, ElementsAre((folder_ / "stop_test.cpp").string()));
  EXPECT_TRUE(stops.pending);
  EXPECT_THAT(walks.owners, ElementsAre((folder_ / "walk.yaml").string()));
  EXPECT_FALSE(walks.pending);
  EXPECT_EQ(walks.bytes, fs::file_size(store_.trace_file("Walker.Walks")));
}

}  // namespace
}  // namespace rehearse
