// The reports of failing tests: one each, and one index of all, even of several programs.
#include <gmock/gmock.h>
#include <rehearse/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "gtest/testing/test_reports.h"
#include "small_traces.h"
#include "support/files.h"
#include "swinging_arm.h"

namespace rehearse {
namespace {

using internal::TestVerdict;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

using test::read_file;

/// A box that falls for 50 ms, a golden of it, and a page that needs no npm.
class TestReports : public ::testing::Test {
 protected:
  TestReports() {
    for (const char* variable : {"REHEARSE_GOLDEN", "REHEARSE_PENDING", "CI", "REHEARSE_REPORT"}) unsetenv(variable);
    set_test_folders({folder_.path().string(), (folder_ / "golden").string(), folder_.path().string(), ""});
    std::filesystem::create_directories(folder_ / "golden");
    std::ofstream(folder_ / "page.html") << "<!doctype html><html><!-- REHEARSE DATA --></html>";
    setenv("REHEARSE_REPORT_PAGE", (folder_ / "page.html").c_str(), 1);
    setenv("REHEARSE_GOLDEN", "new", 1);
    EXPECT_TRUE(internal::match_golden(fall(1.0), "Box.Falls").passed);
    unsetenv("REHEARSE_GOLDEN");
    for (const char* kind : {".mcap", ".txt"})  // under another name: a program has one recording for each
      std::filesystem::copy_file(folder_ / (std::string("golden/Box.Falls") + kind),
                                 folder_ / (std::string("golden/Box.Lands") + kind));
  }
  ~TestReports() override {
    set_test_folders({FIXTURES_DIR, "golden", ".", ""});
    unsetenv("REHEARSE_REPORT_PAGE");
    unsetenv("REHEARSE_REPORT");
  }

  /// From that height [m].
  Trace fall(double height) {
    std::ofstream(folder_ / "fall.yaml")
        << "rehearse: 1\nduration: 0.05\nbodies: [{name: Box, sphere: {radius: 0.1}, mass: 1, position: [0, 0, "
        << height << "]}]\n";
    return record("fall.yaml");
  }
  std::filesystem::path traces(const std::string& name) const { return folder_ / ("traces/" + name); }

  testing::TemporaryFolder folder_;
};

TEST_F(TestReports, OfATestThatFailsIsNamedByItsFailure) {
  const TestVerdict verdict = internal::match_golden(fall(1.01), "Box.Lands");
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message,
              ContainsRegex(
                  "\nin a browser: file:///.*/traces/Box.Lands.html#tick=0\nall tests: file:///.*/traces/index.html$"));
  EXPECT_THAT(read_file(traces("Box.Lands.html")),
              AllOf(HasSubstr("a report of Rehearse"), HasSubstr("\"state\":\"beyond\""), HasSubstr("\"levels\"")));
  const std::string index = read_file(traces("index.html"));
  EXPECT_THAT(index, HasSubstr("<h1>1 of 2 tests failed</h1>"));
  EXPECT_THAT(index, HasSubstr("<a href=\"Box.Lands.html#tick=0\">Box.Lands</a>"));
  EXPECT_THAT(index, HasSubstr("Box/Box/position/z is beyond "));
}

TEST_F(TestReports, AreNotMadeOfTestsThatPass) {
  EXPECT_TRUE(internal::match_golden(fall(1.0), "Box.Falls").passed);
  EXPECT_FALSE(std::filesystem::exists(traces("Box.Falls.html")));
  EXPECT_FALSE(std::filesystem::exists(traces("index.html")));
  setenv("REHEARSE_REPORT", "always", 1);
  EXPECT_TRUE(internal::match_golden(fall(1.0), "Box.Falls").passed);
  EXPECT_THAT(read_file(traces("Box.Falls.html")), HasSubstr("\"state\":\"equal\""));
  EXPECT_THAT(read_file(traces("index.html")), HasSubstr("<h1>0 of 1 test failed"));
}

TEST_F(TestReports, GoWhenTheirTestIsRightAgain) {
  EXPECT_FALSE(internal::match_golden(fall(1.01), "Box.Falls").passed);
  EXPECT_TRUE(internal::match_golden(fall(1.0), "Box.Falls").passed);
  EXPECT_FALSE(std::filesystem::exists(traces("Box.Falls.html")));
  EXPECT_THAT(read_file(traces("index.html")), AllOf(HasSubstr("<h1>0 of 1 test failed"), Not(HasSubstr("href"))));
}

TEST_F(TestReports, AreNotMadeIfNobodyWantsThem) {
  setenv("REHEARSE_REPORT", "never", 1);
  EXPECT_THAT(internal::match_golden(fall(1.01), "Box.Falls").message, Not(HasSubstr("in a browser")));
  EXPECT_FALSE(std::filesystem::exists(traces("index.html")));
}

TEST_F(TestReports, SayWhatIsMissingIfThePageIs) {
  setenv("REHEARSE_REPORT_PAGE", (folder_ / "missing.html").c_str(), 1);
  const TestVerdict verdict = internal::match_golden(fall(1.01), "Box.Falls");
  EXPECT_THAT(verdict.message, HasSubstr("\nthere is no report to look at: the page of reports can't be read"));
  EXPECT_THAT(read_file(traces("index.html")), AllOf(HasSubstr("Box.Falls"), Not(HasSubstr("href"))));
}

TEST_F(TestReports, ShowAReplayThatDiffersBesideItsGolden) {
  const std::filesystem::path controller = folder_ / "Swing.so", sources = TEST_CONTROLLERS;
  std::filesystem::copy_file(sources / "HingePd.so", controller);
  testing::write_swinging_arm(folder_.path(), controller.string());
  setenv("REHEARSE_GOLDEN", "new", 1);
  EXPECT_TRUE(internal::match_golden(record("swing.yaml"), "Arm.Swings").passed);
  unsetenv("REHEARSE_GOLDEN");
  EXPECT_TRUE(internal::replay_golden("Arm.Swings", "Arm.Repeats").passed);
  EXPECT_FALSE(std::filesystem::exists(traces("Arm.Repeats.replay.html")));

  std::filesystem::remove(controller);
  std::filesystem::copy_file(sources / "HingePdChanged.so", controller);
  const TestVerdict verdict = internal::replay_golden("Arm.Swings", "Arm.Repeats");
  EXPECT_THAT(verdict.message, HasSubstr("SHOULDER/u is beyond ±0.001 N·m from tick 70 (0.07 s) on"));
  EXPECT_THAT(verdict.message, ContainsRegex("\nin a browser: file:///.*/traces/Arm.Repeats.replay.html#tick=70\n"
                                             "all tests: file:///.*/traces/index.html$"));
  EXPECT_THAT(read_file(traces("Arm.Repeats.replay.html")), HasSubstr("SHOULDER/u is beyond ±0.001 N·m from tick 70"));
  EXPECT_THAT(read_file(traces("index.html")),
              ContainsRegex("<tr class=\"differs\"[^>]*>.*Arm.Repeats</a><br><small>replay</small>"));
}

TEST_F(TestReports, FailNoReplayThatARuleForCommandsAllows) {
  const std::filesystem::path controller = folder_ / "Swing.so", sources = TEST_CONTROLLERS;
  for (const auto& [pattern, passes] : {std::pair("Arm/*/output/*", true), {"*", false}}) {
    std::filesystem::copy_file(sources / "HingePd.so", controller);
    testing::write_swinging_arm(folder_.path(), controller.string(),
                                "tolerances: [{channel: \"" + std::string(pattern) + "\", atol: 1000}]\n");
    const std::string golden = passes ? "Arm.Swings" : "Arm.SwingsToo";
    setenv("REHEARSE_GOLDEN", "new", 1);
    EXPECT_TRUE(internal::match_golden(record("swing.yaml"), golden).passed);
    unsetenv("REHEARSE_GOLDEN");
    std::filesystem::remove(controller);
    std::filesystem::copy_file(sources / "HingePdChanged.so", controller);
    EXPECT_EQ(internal::replay_golden(golden, golden).passed, passes) << pattern;
    std::filesystem::remove(controller);
  }
}

TEST_F(TestReports, ListAllKindsOfTestsFailedOnesFirst) {
  EXPECT_TRUE(internal::match_golden(fall(1.0), "Box.Falls").passed);
  std::ofstream(folder_ / "expecting.yaml")
      << read_file(folder_ / "fall.yaml") << "expect: [{channel: Box/Box/position/z, above: 2}]\n";
  const Trace low = record("expecting.yaml");
  const TestVerdict violated = internal::hold_expectations(low, "Box.IsHigh");
  EXPECT_THAT(violated.message, ContainsRegex("\nin a browser: file:///.*/traces/Box.IsHigh.expectations.html#tick=0\n"
                                              "all tests: file:///.*/traces/index.html$"));
  EXPECT_FALSE(internal::replay_golden("Box.Falls", "Box.Repeats").passed) << "it has no controllers";
  EXPECT_THROW(internal::record_for_test("missing.yaml", "Box.Starts"), std::runtime_error);
  const std::string index = read_file(traces("index.html"));
  EXPECT_THAT(index, HasSubstr("<h1>3 of 4 tests failed</h1>"));
  EXPECT_THAT(index, ContainsRegex("<tr class=\"failed\"[^>]*>.*Box.Repeats<br><small>replay</small>.*no controller"));
  EXPECT_THAT(index, ContainsRegex("<tr class=\"failed\"[^>]*>.*Box.Starts<br><small>run</small>.*missing.yaml"));
  EXPECT_THAT(index,
              ContainsRegex("<tr class=\"differs\"[^>]*>.*Box.IsHigh</a><br><small>expectations</small>.*above 2 m"));
  EXPECT_THAT(index, ContainsRegex("<tr class=\"passed\">.*Box.Falls<br><small>golden</small>"));
  const std::vector<std::size_t> order{index.find("Box.Repeats<"), index.find("Box.Starts<"), index.find("Box.IsHigh<"),
                                       index.find("Box.Falls<")};
  EXPECT_TRUE(std::ranges::is_sorted(order)) << index;
}

TEST_F(TestReports, ShowTheRobotWhereItDiffersFirst) {
  EXPECT_FALSE(internal::match_golden(fall(1.01), "Box.Lands").passed);
  const std::string index = read_file(traces("index.html")), begin = "src=\"data:image/png;base64,";
  const std::size_t at = index.find(begin);
  ASSERT_NE(at, std::string::npos);
  EXPECT_THAT(index, HasSubstr("<img alt=\"the robot at tick 0\""));
  const std::string coded = index.substr(at + begin.size(), index.find('"', at + begin.size()) - at - begin.size());
  EXPECT_GT(coded.size(), 500u);
  EXPECT_EQ(coded.substr(0, 8), "iVBORw0K");  // PNG's signature
}

TEST_F(TestReports, OfARunThatDidNotBeginGoWhenItRuns) {
  std::filesystem::remove(folder_ / "fall.yaml");
  EXPECT_THROW(internal::record_for_test("fall.yaml", "Box.Starts"), std::runtime_error);
  EXPECT_THAT(read_file(traces("index.html")), HasSubstr("Box.Starts"));
  fall(1.0);
  internal::record_for_test("fall.yaml", "Box.Starts");
  EXPECT_FALSE(internal::match_golden(fall(1.01), "Box.Lands").passed);
  EXPECT_THAT(read_file(traces("index.html")), Not(HasSubstr("Box.Starts")));
}

TEST_F(TestReports, OfManyProgramsAtOnceAreAllListed) {
  constexpr int programs = 4, tests = 5;
  const Trace trace = fall(1.01);
  internal::ComparedTest compared;
  compared.golden = folder_ / "golden/Box.Falls.mcap";
  std::vector<pid_t> children;
  for (int program = 0; program < programs; ++program) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int test = 0; test < tests; ++test)
        internal::keep_test_report(trace, "Program" + std::to_string(program) + ".Test" + std::to_string(test),
                                   "golden", {false, "it <fell>"}, compared);
      _exit(0);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  const std::string index = read_file(traces("index.html"));
  for (int program = 0; program < programs; ++program)
    for (int test = 0; test < tests; ++test)
      EXPECT_THAT(index, HasSubstr(">Program" + std::to_string(program) + ".Test" + std::to_string(test) + "</a>"));
  EXPECT_THAT(index, HasSubstr("it &lt;fell&gt;"));
}

}  // namespace
}  // namespace rehearse
