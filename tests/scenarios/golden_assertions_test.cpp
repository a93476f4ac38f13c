// EXPECT_MATCHES_GOLDEN and EXPECT_HOLDS: their arguments and their messages.
#include <rehearse/gtest.h>

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>

#include "core/check/noise_floor.h"
#include "small_traces.h"
#include "support/files.h"

namespace rehearse {
namespace {

using internal::MatchOptions;
using internal::TestVerdict;
using ::testing::HasSubstr;
using ::testing::Not;

/// A box that falls for 50 ms, and a golden of it; each in folders of the test's own.
class GoldenAssertion : public ::testing::Test {
 protected:
  GoldenAssertion() {
    unsetenv("REHEARSE_GOLDEN");
    unsetenv("REHEARSE_PENDING");
    unsetenv("CI");
    set_test_folders({folder_.path().string(), (folder_ / "golden").string(), folder_.path().string(), ""});
    std::filesystem::create_directories(folder_ / "golden");
  }
  ~GoldenAssertion() override { set_test_folders({FIXTURES_DIR, "golden", ".", ""}); }

  /// A box that falls from that height [m], with more lines of scenario.
  void write_fall(double height, const std::string& lines) {
    std::ofstream(folder_ / "fall.yaml")
        << std::setprecision(17)
        << "rehearse: 1\nduration: 0.05\nbodies: [{name: Box, sphere: {radius: 0.1}, mass: 1, position: [0, 0, "
        << height << "]}]\n"
        << lines;
  }
  Trace fall(double height = 1.0, const std::string& lines = "") {
    write_fall(height, lines);
    return record("fall.yaml");
  }
  /// Makes the golden of a fall from 1 m.
  void make_golden() {
    setenv("REHEARSE_GOLDEN", "new", 1);
    EXPECT_TRUE(internal::match_golden(fall(), "Box.Falls").passed);
    unsetenv("REHEARSE_GOLDEN");
  }
  /// The same under another name: one name is for one recording of a program.
  void copy_golden(const std::string& name) {
    for (const char* kind : {".mcap", ".txt", ".noise"})
      if (const auto file = folder_ / (std::string("golden/Box.Falls") + kind); std::filesystem::exists(file))
        std::filesystem::copy_file(file, folder_ / ("golden/" + name + kind));
  }
  template <class... Overrides>
  TestVerdict match(const Trace& trace, const Overrides&... overrides) {
    MatchOptions options;
    (set_option(options, overrides), ...);
    last_name_ = "Box.Falls-" + std::to_string(++matched_);
    copy_golden(last_name_);
    return internal::match_golden(trace, last_name_, options);
  }

  testing::TemporaryFolder folder_;
  std::string last_name_;  // of the golden that was matched last
  int matched_ = 0;
};

const std::string push = "pushes: [{body: Box, force: [0, 0, 5], from: 0.03, until: 0.05}]\n";
constexpr double slightly = 1.0 + 1e-12;  // [m]: within what a scenario tolerates by default

TEST_F(GoldenAssertion, ReplaysNothingOfARunWithoutControllers) {
  make_golden();
  const TestVerdict verdict = internal::replay_golden("Box.Falls", "Box.Repeats");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("nothing was compared: no controller commands anything in "));
}

TEST_F(GoldenAssertion, KeepsToTheScenariosTolerancesUnlessTold) {
  make_golden();
  EXPECT_TRUE(match(fall(slightly)).passed);
  EXPECT_FALSE(match(fall(1.01)).passed);
}

TEST_F(GoldenAssertion, WantsTheSameBitsIfExact) {
  make_golden();
  EXPECT_TRUE(match(fall(), Exact{}).passed);
  const TestVerdict verdict = match(fall(slightly), Exact{});
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("differs at tick 0 (0 s): /Box/Box/pose position/z"));
}

TEST_F(GoldenAssertion, MakesExceptionsOfExactInAnyOrder) {
  make_golden();
  const Near heights{"*position/z", 1e-6};
  EXPECT_TRUE(match(fall(slightly), Exact{}, heights).passed);
  EXPECT_TRUE(match(fall(slightly), heights, Exact{}).passed);
  EXPECT_FALSE(match(fall(slightly), Exact{}, Near{"*position/x", 1e-6}).passed);
}

TEST_F(GoldenAssertion, TakesSeveralNearsOfWhichTheLastThatMatchesDecides) {
  make_golden();
  const Trace higher = fall(1.01);
  EXPECT_TRUE(match(higher, Near{"*position/z", 0.02}).passed);
  EXPECT_FALSE(match(higher, Near{"*position/z", 0.02}, Near{"Box/*", 0.001}).passed);
  EXPECT_TRUE(match(higher, Near{"Box/*", 0.001}, Near{"*position/z", 0.0, 0.02}).passed) << "2 % of 1 m";
}

TEST_F(GoldenAssertion, ComesAfterTheRulesOfTheScenario) {
  make_golden();
  const std::string wide = "tolerances: [{channel: \"*\", atol: 1}]\n";
  EXPECT_TRUE(match(fall(1.01, wide)).passed);
  EXPECT_FALSE(match(fall(1.01, wide), Near{"Box/Box/position/*", 0.001}).passed);
}

/// A noise file beside the golden: a perturbed run left its tolerances at that time [s].
void measure_horizon(const std::filesystem::path& golden, double horizon) {
  NoiseFloor noise;
  noise.scenario = "fall";
  noise.recording = hash_of_recording(*Trace::load(golden));
  noise.duration = 0.05;
  noise.perturbations.push_back({"last bits, pattern 1", "", false, true, true, horizon, {}});
  const auto written = write_noise_floor(noise, noise_file_of(golden));
  ASSERT_TRUE(written) << to_string(written.errors());
}

TEST_F(GoldenAssertion, ComparesUpToTheMeasuredHorizonIfTheScenarioStatesNone) {
  make_golden();
  measure_horizon(folder_ / "golden/Box.Falls.mcap", 0.036);  // times 0.8: before the push
  EXPECT_TRUE(match(fall(1.0, push)).passed);
  EXPECT_FALSE(match(fall(1.0, push + "horizon: 0.05\n")).passed) << "the scenario knows better";
  EXPECT_FALSE(match(fall(1.0, push), Until{0.05}).passed) << "and the test best";
  measure_horizon(folder_ / "golden/Box.Falls.mcap", 0.05);
  EXPECT_FALSE(match(fall(1.0, push)).passed);
}

TEST_F(GoldenAssertion, ComparesUpToATime) {
  make_golden();
  EXPECT_FALSE(match(fall(1.0, push)).passed);
  const TestVerdict verdict = match(fall(1.0, push), Until{0.03}, Exact{});
  EXPECT_TRUE(verdict.passed) << verdict.message;
  EXPECT_TRUE(match(fall(1.0, push + "horizon: 0.03\n")).passed) << "as the scenario says";
  EXPECT_FALSE(match(fall(1.0, push + "horizon: 0.03\n"), Until{0.05}).passed) << "unless the test says otherwise";
}

TEST_F(GoldenAssertion, RefusesWhatCannotBeMeant) {
  make_golden();
  const Trace trace = fall();
  EXPECT_THAT(match(trace, Near{"Box/*", -1.0}).message, HasSubstr("a tolerance is a number, at least 0"));
  EXPECT_THAT(match(trace, Near{"Box/*", std::nan("")}).message, HasSubstr("a tolerance is a number"));
  EXPECT_THAT(match(trace, Near{"Bax/Box/position/z", 1e-6}).message,
              HasSubstr("the run has no such series; the nearest are Box/Box/position/z, "));
  EXPECT_THAT(match(trace, Until{0.06}).message, HasSubstr("expected a time in the run, 0 to 0.05 s"));
  EXPECT_THAT(match(trace, Until{-1.0}).message, HasSubstr("expected a time in the run"));
  EXPECT_THAT(match(trace, Levels{}).message, HasSubstr("expected controller, plant or closed"));
}

TEST_F(GoldenAssertion, HoldsWhatTheScenarioExpects) {
  make_golden();
  const std::string high = "expect: [{channel: Box/Box/position/z, above: 0.5}]\n";
  const std::string low = "expect: [{channel: Box/Box/position/z, below: 0.5, at: end}]\n";
  EXPECT_TRUE(match(fall(1.0, high)).passed);
  const TestVerdict verdict = match(fall(1.0, low));
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("expected Box/Box/position/z below 0.5 m at the end: 0.98"));
  EXPECT_THAT(verdict.message, HasSubstr("equal bit for bit")) << "which is said as well";
  EXPECT_TRUE(std::filesystem::exists(folder_ / ("goldens/pending/" + last_name_ + ".mcap")));
}

TEST_F(GoldenAssertion, MakesNoGoldenOfARunThatIsNotAsExpected) {
  setenv("REHEARSE_GOLDEN", "accept", 1);
  const TestVerdict verdict = match(fall(1.0, "expect: [{channel: Box/Box/position/z, above: 2}]\n"));
  unsetenv("REHEARSE_GOLDEN");
  EXPECT_FALSE(verdict.passed);
  EXPECT_FALSE(std::filesystem::exists(folder_ / ("golden/" + last_name_ + ".mcap")));
}

TEST_F(GoldenAssertion, NeedsNoGoldenToHold) {
  EXPECT_HOLDS(fall(1.0, "expect: [{channel: Box/Box/position/z, above: 0.5}]\n"));
  const TestVerdict verdict = internal::hold_expectations(
      fall(1.0, "expect:\n  - {channel: Box/Box/position/z, above: 0.99, from: 0.01}\n"), "Box.Falls");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("fall.yaml:5: expected Box/Box/position/z above 0.99 m from 0.01 s on: "));
}

TEST_F(GoldenAssertion, DoesNotHoldNothing) {
  const TestVerdict verdict = internal::hold_expectations(fall(), "Box.Falls");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, HasSubstr("the scenario has no expectations"));
}

TEST_F(GoldenAssertion, NamesThePartThatChanged) {
  make_golden();
  const TestVerdict verdict = match(fall(1.0, push));
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, ::testing::StartsWith("scenario.yaml:4 (pushes is new) changed: under the golden's "
                                                     "commands, Box/Box/"));
  EXPECT_THAT(verdict.message, HasSubstr("\n  controller: equal; plant: differs up to tick 31; closed: differs\n"));
  EXPECT_THAT(verdict.message, HasSubstr("\n  stage "));
  EXPECT_THAT(verdict.message, HasSubstr("look at it: rehearse golden review " + last_name_));
}

TEST_F(GoldenAssertion, ComparesTheLevelsThatAreWanted) {
  make_golden();
  const Levels plant{Level::plant}, both{Level::plant, Level::closed};
  EXPECT_TRUE(match(fall(), both).passed);
  const TestVerdict moved = match(fall(1.0, push), plant);
  EXPECT_FALSE(moved.passed);
  EXPECT_THAT(moved.message, HasSubstr("; plant: differs; closed: not compared"));
  EXPECT_FALSE(match(fall(1.0, push + "horizon: 0.01\n"), both).passed) << "of the plant there is no horizon";
  EXPECT_TRUE(match(fall(1.0, push + "horizon: 0.01\n")).passed);
}

TEST_F(GoldenAssertion, ComparesOtherLevelsOnlyOfItsOwnRecordings) {
  make_golden();
  std::filesystem::copy_file(fall().file(), folder_ / "elsewhere.mcap");
  const auto elsewhere = Trace::load(folder_ / "elsewhere.mcap");
  EXPECT_TRUE(match(*elsewhere).passed);
  EXPECT_THAT(match(*elsewhere, Levels{Level::plant}).message, HasSubstr("a recording that this program made"));
}

TEST_F(GoldenAssertion, StandsInTheReportThatCiReads) {
  make_golden();
  write_fall(1.01, "");
  const std::string line =
      "cd '" + folder_.path().string() + "' && '" FAILING_ASSERTION "' --gtest_output=xml:report.xml > out.txt 2>&1";
  EXPECT_NE(std::system(line.c_str()), 0);
  const std::string text = test::read_file(folder_ / "report.xml");
  EXPECT_THAT(text, HasSubstr("<failure message="));
  EXPECT_THAT(text, HasSubstr("Box/Box/position/z is beyond ±1e-09 m from tick 0 (0 s) on"));
  EXPECT_THAT(text, HasSubstr("look at it: rehearse golden review Box.Falls"));
}

/// The exceptions of a misspelt name stand at the line of the test, and not in an unknown file.
TEST_F(GoldenAssertion, PlacesExceptionsAtTheLineOfTheTest) {
  write_fall(1.0, "");
  const std::string line =
      "cd '" + folder_.path().string() + "' && '" FAILING_ASSERTION "' --gtest_filter=Misread.* > out.txt 2>&1";
  EXPECT_NE(std::system(line.c_str()), 0);
  const std::string text = test::read_file(folder_ / "out.txt");
  EXPECT_THAT(text, Not(HasSubstr("unknown file")));
  EXPECT_THAT(text, HasSubstr("failing_assertion.cpp:11: Failure"));
  EXPECT_THAT(text, HasSubstr("has no series \"Box/Box/positon/z\"; the nearest are Box/Box/position/z"));
  EXPECT_THAT(text, HasSubstr("failing_assertion.cpp:14: Failure"));
  EXPECT_THAT(text, HasSubstr("failing_assertion.cpp:16: Failure"));
}

}  // namespace
}  // namespace rehearse
