// The work on campaigns whose simulation is a function of this test: it writes an empty recording.
#include "scenario_files.h"

#include <rehearse/mcap.h>
#include <rehearse/shrink.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

/// True if a run with these values fails.
using Fails = std::function<bool(double mass, double height)>;

Simulation simulation_of(const Fails& fails, const fs::path& full_disk = "") {
  Simulation simulation;
  simulation.record = [=](const Scenario& scenario, const fs::path& trace, const RecordOptions&) -> Result<RunSummary> {
    auto writer = mcap::Writer::create(trace);
    if (!writer) return writer.errors();
    const ScenarioBody& box = scenario.bodies[0];
    const double mass = box.model->links[0].inertial.mass, height = box.position.z();
    if (fs::exists(full_disk) && height > 1.5) return error("can't write the trace: No space left on device");
    REHEARSE_TRY((*writer)->close());
    RunSummary summary;
    if (fails(mass, height)) {
      summary.end = RunEnding::threw;
      summary.failure = error("the box fails");
    }
    return summary;
  };
  return simulation;
}

Campaign campaign_of(const std::string& mass, const std::string& height, const Simulation& simulation) {
  const fs::path scenario =
      write_file("box.yaml",
                 "rehearse: 1\nduration: 1\nbodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 2, "
                 "position: [0, 0, 1]}\nvary:\n  mass: {path: bodies.Box.mass, grid: [" +
                     mass + "]}\n  height: {path: \"bodies.Box.position[2]\", grid: [" + height + "]}\n");
  auto campaign = create_campaign(scenario, scenario.parent_path() / "campaign", {}, simulation);
  EXPECT_TRUE(campaign) << to_string(campaign.errors());
  return *std::move(campaign);
}

TEST(RunCases, LeavesACaseWithoutAResultIfTheDiskIsFull) {
  const fs::path full = write_file("full", "");
  const Simulation simulation = simulation_of([](double mass, double) { return mass > 2.5; }, full);
  Campaign campaign = campaign_of("2, 3", "1, 2", simulation);
  const auto stopped = run_cases(campaign, {}, simulation);
  ASSERT_FALSE(stopped);
  EXPECT_THAT(to_string(stopped.errors()), HasSubstr("No space left on device (it has no result; remove the cause"));
  auto summary = summary_of(campaign);
  ASSERT_TRUE(summary);
  EXPECT_GE(summary->missing, 1);
  EXPECT_EQ(summary->verdicts[static_cast<std::size_t>(CaseVerdict::invalid)], 0);
  fs::remove(full);
  ASSERT_TRUE(run_cases(campaign, {}, simulation));
  summary = summary_of(campaign);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->missing, 0);
  EXPECT_EQ(summary->passed(), 2);
  EXPECT_EQ(summary->verdicts[static_cast<std::size_t>(CaseVerdict::failed)], 2);
}

TEST(Shrink, RemovesAParameterThatBecomesNeedless) {
  // of a heavy box the height matters, of a lighter one it doesn't
  const Simulation simulation =
      simulation_of([](double mass, double height) { return mass > 2.1 && (height > 1.0 || mass < 2.3); });
  const Campaign campaign = campaign_of("2, 3", "1, 2", simulation);
  const auto shrunk = shrink(campaign, 3, {}, simulation);
  ASSERT_TRUE(shrunk) << to_string(shrunk.errors());
  EXPECT_TRUE(shrunk->finished);
  EXPECT_EQ(shrunk->differs, (std::vector<std::size_t>{0})) << "only the mass";
  EXPECT_NEAR(std::stod(shrunk->values[0]), 2.1, 0.005);
  EXPECT_EQ(shrunk->result.reason, "the box fails");
}

TEST(Shrink, MovesAParameterFurtherAfterAnotherHasMoved) {
  // the less the mass, the less height is needed
  const Simulation simulation = simulation_of([](double mass, double height) {
    return mass > 2.2 && height > 1.0 + std::min(0.9, 0.2 * (mass - 1.9)) && (mass > 2.6 || height < 1.5);
  });
  const Campaign campaign = campaign_of("2, 3", "1, 2", simulation);
  const auto shrunk = shrink(campaign, 3, {}, simulation);
  ASSERT_TRUE(shrunk) << to_string(shrunk.errors());
  EXPECT_TRUE(shrunk->finished);
  EXPECT_NEAR(std::stod(shrunk->values[0]), 2.2, 0.01) << "after the height is below 1.5";
  EXPECT_NEAR(std::stod(shrunk->values[1]), 1.06, 0.01) << "after the mass is near 2.2";
}

}  // namespace
}  // namespace rehearse
