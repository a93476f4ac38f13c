// rehearse::sweep and EXPECT_PASS_RATE.
#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <rehearse/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class PassRate : public ::testing::Test {
 protected:
  PassRate() { rehearse::set_test_folders({folder_.path().string(), "", (folder_ / "output").string(), ""}); }

  /// A box falls 20 ms from a height of 0.2 m to 1 m: it must be above that limit.
  std::string box(double limit, const std::string& claims = "") const {
    std::ofstream(folder_ / "box.yaml") << R"(rehearse: 1
duration: 0.02
bodies:
  - {name: Box, box: {size: [0.1, 0.1, 0.1]}, mass: 1, position: [0, 0, 0.7]}
expect:
  - {channel: Box/Box/position/z, above: )"
                                        << limit << R"(}
vary:
  height: {path: "bodies.Box.position[2]", uniform: [0.2, 1]}
)" << claims;
    return "box.yaml";
  }

  const rehearse::test::TemporaryFolder folder_;
};

TEST_F(PassRate, IsThatOfTheCases) {
  const rehearse::SweepResult result = rehearse::sweep(box(0.25), {60, 1});
  EXPECT_EQ(result.cases, 60);
  EXPECT_GT(result.passed, 45);
  EXPECT_LT(result.passed, 60);
  EXPECT_LT(result.low, static_cast<double>(result.passed) / 60.0);
  EXPECT_GT(result.high, static_cast<double>(result.passed) / 60.0);
  ASSERT_PASS_RATE(result, 0.9);
  EXPECT_TRUE(fs::exists(fs::path(result.folder) / "report.html"));
  EXPECT_EQ(fs::path(result.folder).filename(), "PassRate.IsThatOfTheCases");
}

TEST_F(PassRate, FailsByItsUpperBoundAndNamesTheCases) {
  const rehearse::SweepResult result = rehearse::sweep(box(0.6), {60, 1});
  const auto judged = rehearse::internal::HasPassRate("", "", result, 0.99);
  EXPECT_FALSE(judged);
  EXPECT_THAT(judged.message(), HasSubstr("of 60 cases pass"));
  EXPECT_THAT(judged.message(), HasSubstr("is below 99 %"));
  EXPECT_THAT(judged.message(), HasSubstr("violated: expected Box/Box/position/z above 0.6 m: "));
  EXPECT_THAT(judged.message(), HasSubstr("rehearse sweep shrink "));
  EXPECT_THAT(judged.message(), HasSubstr("report.html"));
  EXPECT_NONFATAL_FAILURE(EXPECT_PASS_RATE(result, 0.99), "is below 99 %");
}

/// Of the heights about 94 % are above 0.25 m.
TEST_F(PassRate, OfTheScenarioHasThreeAnswers) {
  const auto swept = [this](const std::string& rate) {
    return rehearse::sweep(box(0.25, "pass_rate: {at_least: " + rate + "}\n"), {60, 1});
  };
  EXPECT_SWEEP_PASSES(swept("0.7"));
  const rehearse::SweepResult undecided = swept("0.92"), fails = swept("0.999");
  EXPECT_TRUE(undecided.undecided);
  EXPECT_FALSE(fails.undecided);
  const auto of_undecided = rehearse::internal::HoldsItsClaims("", undecided);
  EXPECT_FALSE(of_undecided);
  EXPECT_THAT(of_undecided.message(), HasSubstr("it is undecided whether at least 92 % pass"));
  EXPECT_THAT(of_undecided.message(), HasSubstr("would decide it if the rate stays"));
  const auto of_failing = rehearse::internal::HoldsItsClaims("", fails);
  EXPECT_FALSE(of_failing);
  EXPECT_THAT(of_failing.message(), HasSubstr("it is false that at least 99.9 % pass"));
  EXPECT_THAT(of_failing.message(), HasSubstr("rehearse sweep shrink "));
  EXPECT_NONFATAL_FAILURE(EXPECT_SWEEP_PASSES(fails), "it is false that at least 99.9 % pass");
}

TEST_F(PassRate, OfAScenarioWithoutAClaimIsThatOfEveryCase) {
  EXPECT_SWEEP_PASSES(rehearse::sweep(box(0.1), {20, 1}));
  EXPECT_FALSE(rehearse::internal::HoldsItsClaims("", rehearse::sweep(box(0.6), {20, 1})));
}

TEST_F(PassRate, FailsIfAStateWasNeverTried) {
  const std::string claims = "pass_rate: {at_least: 0.1}\nsometimes:\n  low: \"Box/Box/position/z < 0.5\"\n";
  ASSERT_SWEEP_PASSES(rehearse::sweep(box(0.1, claims), {40, 1}));
  const rehearse::SweepResult grounded =
      rehearse::sweep(box(0.1, claims + "  flies away: \"Box/Box/position/z > 5\"\n"), {40, 1});
  EXPECT_EQ(grounded.never_tried, std::vector<std::string>{"flies away"});
  EXPECT_TRUE(grounded.passes);
  for (const auto& judged :
       {rehearse::internal::HoldsItsClaims("", grounded), rehearse::internal::HasPassRate("", "", grounded, 0.5)}) {
    EXPECT_FALSE(judged);
    EXPECT_THAT(judged.message(), HasSubstr("never tried: no case reached flies away"));
  }
}

TEST_F(PassRate, FailsIfAKeptFailureFailsAgain) {
  std::ofstream(folder_ / "CMakeLists.txt") << "\n";
  fs::create_directories(folder_ / "failures");
  box(0.1);
  fs::rename(folder_ / "box.yaml", folder_ / "failures/passes.yaml");
  EXPECT_SWEEP_PASSES(rehearse::sweep(box(0.1), {5, 1}));
  box(0.8);  // above the nominal height
  fs::rename(folder_ / "box.yaml", folder_ / "failures/fails.yaml");
  const auto swept = rehearse::sweep(box(0.1), {5, 1});
  EXPECT_EQ(swept.failing_again.size(), 1u);
  for (const auto& judged :
       {rehearse::internal::HoldsItsClaims("", swept), rehearse::internal::HasPassRate("", "", swept, 0.5)}) {
    EXPECT_FALSE(judged);
    EXPECT_THAT(judged.message(), HasSubstr("a kept failure fails again: "));
    EXPECT_THAT(judged.message(), HasSubstr("failures/fails.yaml: violated: expected Box/Box/position/z above 0.8 m"));
  }
}

TEST_F(PassRate, IsTheSameAfterARunInThisProcess) {
  const rehearse::SweepResult before = rehearse::sweep(box(0.5), {20, 1});
  const rehearse::Trace trace = rehearse::record(box(0.5));
  EXPECT_GT(trace.ticks(), 0);
  const rehearse::SweepResult after = rehearse::sweep(box(0.5), {20, 1, 1});
  EXPECT_EQ(before.verdict, after.verdict);
}

TEST_F(PassRate, OfAScenarioWithoutVariationsIsAnError) {
  std::ofstream(folder_ / "still.yaml")
      << "rehearse: 1\nduration: 0.02\nbodies:\n  - {name: B, box: {size: [1, 1, 1]}, "
         "mass: 1}\n";
  EXPECT_THROW(rehearse::sweep("still.yaml"), std::runtime_error);
}

}  // namespace
