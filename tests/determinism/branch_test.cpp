// A branch without changes equals its recording, message by message, bit for bit: every scenario of the fixtures, both
// solvers.
#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/session.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/clock.h"
#include "fixture_scenarios.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

struct Message {
  std::uint64_t time = 0;
  std::vector<std::byte> data;
};

std::map<std::string, std::vector<Message>> messages_of(const fs::path& file) {
  std::map<std::string, std::vector<Message>> by_topic;
  const auto reader = mcap::Reader::open(file);
  EXPECT_TRUE(reader.ok());
  if (!reader) return by_topic;
  for (const auto& [id, channel] : (*reader)->channels()) by_topic[channel.topic];
  const auto read = (*reader)->for_each_message([&](const mcap::Message& message) {
    by_topic[message.channel->topic].push_back({message.log_time, {message.data.begin(), message.data.end()}});
    return true;
  });
  EXPECT_TRUE(read.ok()) << to_string(read.errors());
  return by_topic;
}

void expect_same_messages(const fs::path& file, const fs::path& branch) {
  const auto wanted = messages_of(file), found = messages_of(branch);
  for (const auto& [topic, messages] : found) EXPECT_TRUE(wanted.count(topic)) << topic << " is in the branch only";
  for (const auto& [topic, messages] : wanted) {
    const auto same_topic = found.find(topic);
    ASSERT_NE(same_topic, found.end()) << topic;
    const std::vector<Message>& others = same_topic->second;
    for (std::size_t i = 0; i < std::min(messages.size(), others.size()); ++i) {
      ASSERT_EQ(messages[i].time, others[i].time) << topic << ", message " << i;
      ASSERT_TRUE(messages[i].data == others[i].data) << topic << " at " << messages[i].time << " ns";
    }
    EXPECT_EQ(messages.size(), others.size()) << topic;
  }
}

class Branches : public ::testing::TestWithParam<FixtureCase> {
 protected:
  const test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Of, Branches, ::testing::ValuesIn(fixture_cases()),
                         [](const auto& of) { return of.param.name + "_" + name_of(of.param.solver); });

TEST_P(Branches, WithoutAnyChangeAreTheirSource) {
  auto scenario = Scenario::load(fs::path(FIXTURES_DIR) / "scenarios" / (GetParam().name + ".yaml"));
  ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
  const bool other_solver = scenario->solver.method != GetParam().solver;
  if (other_solver) {  // a recording carries the scenario's text
    const std::string wanted = name_of(GetParam().solver), other = name_of(scenario->solver.method);
    std::string& text = scenario->text;
    if (const std::size_t stated = text.find("method: " + other); stated != std::string::npos)
      text.replace(stated, 8 + other.size(), "method: " + wanted);
    else
      text += "\nsolver: {method: " + wanted + "}\n";
    scenario->solver.method = GetParam().solver;
  }
  scenario->duration = std::min(scenario->duration, 0.5);
  const bool has_meshes = scenario->text.find("mesh_arm.urdf") != std::string::npos;
  const fs::path source = folder_ / "source.mcap", branch = folder_ / "branch.mcap";
  const auto run = record(*scenario, source);
  ASSERT_TRUE(run.ok()) << to_string(run.errors());
  ASSERT_FALSE(run->failure) << to_string(*run->failure);
  for (const std::int64_t tick : {run->ticks * 2 / 3 + 1, std::int64_t{1}}) {
    BranchPoint from{source, std::nullopt, tick};
    BranchOptions options;
    const fs::path copy = fs::path(FIXTURES_DIR) / "scenarios" / (GetParam().name + ".yaml");
    if (has_meshes && other_solver)
      GTEST_SKIP() << "its meshes come with the scenario's file, which has its own solver";
    if (has_meshes) options.scenario = copy;
    const auto made = record_branch(from, branch, options);
    ASSERT_TRUE(made.ok()) << to_string(made.errors());
    EXPECT_FALSE(made->run.failure) << to_string(*made->run.failure);
    EXPECT_TRUE(made->before.equal());
    expect_same_messages(source, branch);
    if (HasFailure()) FAIL() << "branched at tick " << tick << ": " << made->world;
  }
  const auto replayed = replay(branch);
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
}

}  // namespace
}  // namespace rehearse
