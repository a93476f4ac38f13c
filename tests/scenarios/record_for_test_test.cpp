#include <rehearse/gtest.h>

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "small_traces.h"
#include "support/environment_variable.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

/// Folders of the test's own.
class TestSupport : public ::testing::Test {
 protected:
  TestSupport() {
    unsetenv("REHEARSE_GOLDEN");
    unsetenv("REHEARSE_PENDING");
    set_test_folders({FIXTURES_DIR, (folder_ / "golden").string(), folder_.path().string(), ""});
    std::filesystem::create_directories(folder_ / "golden");
  }
  testing::TemporaryFolder folder_;
};

TEST_F(TestSupport, RecordsIntoAFileNamedByTheTest) {
  const Trace first = record("scenarios/drop_box.yaml");
  const Trace second = record("scenarios/drop_box.yaml");
  for (const char* name : {"RecordsIntoAFileNamedByTheTest.mcap", "RecordsIntoAFileNamedByTheTest-2.mcap"}) {
    const auto kept = Trace::load(folder_ / "traces" / ("TestSupport." + std::string(name)));
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->values("Box/Box/position/z"), first.values("Box/Box/position/z"));
  }
  EXPECT_EQ(first.values("Box/Box/position/z"), second.values("Box/Box/position/z"));
}

TEST_F(TestSupport, ThrowsWhatIsWrongWithAScenario) {
  try {
    record("broken/scenario_unknown_joint.yaml");
    FAIL() << "it ran";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("scenario_unknown_joint.yaml:"));
  }
}

TEST_F(TestSupport, FailsAMissingGoldenAndKeepsTheRun) {
  const auto verdict = internal::match_golden(record("scenarios/drop_box.yaml"), "Box.Falls");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("there is no golden"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "goldens/pending/Box.Falls.mcap"));
}

TEST_F(TestSupport, WritesAGoldenOnDemandAndThenFindsARunEqualToIt) {
  const Trace trace = record("scenarios/drop_box.yaml");
  const auto written = [&trace] {
    const test::EnvironmentVariable no_ci("CI", nullptr), mode("REHEARSE_GOLDEN", "new");
    return internal::match_golden(trace, "Box.FallsAgain");
  }();
  EXPECT_TRUE(written.passed) << written.message;
  EXPECT_TRUE(internal::match_golden(record("scenarios/drop_box.yaml"), "Box.FallsAgain").passed);
}

TEST_F(TestSupport, SaysThatThereIsNothingToReplay) {
  const auto verdict = internal::replay_golden("Box.Nowhere", "Box.Repeats");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("there is no golden"));
}

TEST_F(TestSupport, LetsTheEnvironmentNameTheFixtures) {
  setenv("REHEARSE_FIXTURES", "/elsewhere", 1);
  EXPECT_EQ(fixture_path("models/a.urdf"), "/elsewhere/models/a.urdf");
  EXPECT_EQ(fixture_path("/models/a.urdf"), "/models/a.urdf");
  unsetenv("REHEARSE_FIXTURES");
}

}  // namespace
}  // namespace rehearse
