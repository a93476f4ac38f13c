// The facts of a run, as the metadata of its recording states them.
#include "core/trace/run_facts.h"

#include <rehearse/mcap.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

using namespace rehearse;

namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(RunFacts, AreReadFromAllRecords) {
  const std::vector<mcap::Metadata> metadata{
      {records::provenance,
       {{facts::trace_version, "1"},
        {facts::trace_revision, "2"},
        {facts::seed, "7"},
        {facts::time_step, "0.001"},
        {facts::duration, "2.5"},
        {facts::source, "log"},
        {"controller.Arm/Reach", "Reach.so 0123"}}},
      {records::files, {{"gains.txt", "abcd"}}},
      {records::branch,
       {{"source", "walk.mcap 01"}, {"loop", "open"}, {"tick", "40"}, {"set.1", "a=1"}, {"set.2", "b=2"}}},
      {records::outcome, {{"ticks", "2500"}, {"complete", "true"}, {"checkpoints", "exact"}}}};
  const RunFacts run = RunFacts::of(metadata);
  EXPECT_EQ(run.provenances, 1);
  EXPECT_EQ(run.trace_version, 1);
  EXPECT_EQ(run.trace_revision, 2);
  EXPECT_EQ(run.seed, 7u);
  EXPECT_EQ(run.time_step, 0.001);
  EXPECT_EQ(run.duration, 2.5);
  EXPECT_TRUE(run.is_of_log);
  EXPECT_THAT(run.controllers, ElementsAre(Pair("Arm/Reach", "Reach.so 0123")));
  EXPECT_TRUE(run.had_library("Arm/Reach", "0123"));
  EXPECT_FALSE(run.had_library("Arm/Reach", "123"));
  EXPECT_FALSE(run.had_library("Arm/Grasp", "0123"));
  EXPECT_THAT(run.files.value(), ElementsAre(Pair("gains.txt", "abcd")));
  EXPECT_FALSE(run.branch.value().simulated);
  EXPECT_EQ(run.branch->tick, 40);
  EXPECT_THAT(run.branch->set, ElementsAre("a=1", "b=2"));
  EXPECT_EQ(run.outcome.value().ticks, 2500);
  EXPECT_TRUE(run.outcome->complete);
  EXPECT_EQ(run.outcome->checkpoints, "exact");
  EXPECT_FALSE(run.outcome->failure);
}

TEST(RunFacts, AreNotThereInAForeignFile) {
  const RunFacts run = RunFacts::of(std::vector<mcap::Metadata>{{"calibration", {{"seed", "3"}}}});
  EXPECT_FALSE(run.provenance);
  EXPECT_FALSE(run.seed);
  EXPECT_FALSE(run.outcome);
  EXPECT_FALSE(run.branch);
  EXPECT_EQ(run.stated(facts::seed), "");
}

TEST(RunFacts, HaveNoNumberWhereNoneIsStated) {
  const RunFacts run = RunFacts::of(std::vector<mcap::Metadata>{
      {records::provenance, {{facts::seed, "7x"}, {facts::time_step, ""}}}, {records::outcome, {{"ticks", "many"}}}});
  EXPECT_FALSE(run.seed);
  EXPECT_FALSE(run.time_step);
  EXPECT_FALSE(run.outcome->ticks);
  EXPECT_EQ(run.trace_revision, 1);  // recordings stated none at first
}

TEST(RunFacts, OfSeveralRecordingsAreTheFirstOnes) {
  const RunFacts run = RunFacts::of(std::vector<mcap::Metadata>{{records::provenance, {{facts::seed, "1"}}},
                                                                {records::provenance, {{facts::seed, "2"}}}});
  EXPECT_EQ(run.provenances, 2);
  EXPECT_EQ(run.seed, 1u);
}

TEST(RunFacts, AreWrittenAsTheyAreRead) {
  const mcap::StringMap failed{
      {"ticks", "3"}, {"complete", "false"}, {"failure", "it crashed"}, {"checkpoints", "none"}};
  EXPECT_EQ(RunOutcome::of(failed).metadata(), failed);
  EXPECT_EQ(RunOutcome{.complete = true}.metadata(), (mcap::StringMap{{"complete", "true"}}));
  const mcap::StringMap branch{
      {"source", "walk.mcap 01"}, {"loop", "closed"},         {"tick", "640"},
      {"time", "0.64"},           {"checkpoint", "tick 512"}, {"push.1", "Box/Box force=1,0,0 @1s"},
      {"controller.1", "a"},      {"acted_until", "640"}};
  EXPECT_EQ(BranchOrigin::of(branch).metadata(), branch);
}

TEST(RunFacts, OfGoldensAreComplete) {
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(FIXTURES_DIR) / ".." / "golden")) {
    if (entry.path().extension() != ".mcap") continue;
    SCOPED_TRACE(entry.path().filename());
    const auto reader = mcap::Reader::open(entry.path());
    ASSERT_TRUE(reader);
    const RunFacts run = RunFacts::of(**reader);
    EXPECT_EQ(run.provenances, 1);
    EXPECT_EQ(run.trace_version, 1);
    EXPECT_TRUE(run.seed && run.time_step && run.duration);
    EXPECT_FALSE(run.controllers.empty());
    ASSERT_TRUE(run.outcome);
    EXPECT_FALSE(run.outcome->failure);
    EXPECT_GT(run.outcome->ticks.value_or(0), 0);
    for (const mcap::Metadata& record : (*reader)->metadata()) {
      if (record.name != records::outcome) continue;
      EXPECT_EQ(run.outcome->metadata(), record.values);
    }
  }
}

}  // namespace
