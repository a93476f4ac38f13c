// From any checkpoint of a recording, a new process continues with the same bits: every scenario of the fixtures, both
// solvers, three ticks each.
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/clock.h"
#include "fixture_scenarios.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

class Checkpoints : public ::testing::TestWithParam<FixtureCase> {
 protected:
  Trace loaded(const std::string& file) const {
    auto trace = Trace::load(folder_ / file);
    EXPECT_TRUE(trace.ok()) << to_string(trace.errors());
    return *std::move(trace);
  }

  const test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Of, Checkpoints, ::testing::ValuesIn(fixture_cases()),
                         [](const auto& of) { return of.param.name + "_" + name_of(of.param.solver); });

/// Each message of `later` is the same bytes in `recording`; those of pictures and scans that had been captured before
/// may be missing there, nothing else. Returns how many were compared.
std::size_t expect_same_messages(const Trace& recording, const Trace& later) {
  std::size_t compared = 0;
  for (const TraceChannel& channel : later.channels()) {
    const TraceChannel* recorded = recording.find_channel(channel.topic);
    if (!recorded || channel.topic == "/tick") continue;
    for (std::size_t i = 0; i < channel.messages(); ++i) {
      // of several messages of one time, as of two feet that are lifted, those of the same rank are compared
      const auto rank = channel.times.begin() + static_cast<std::ptrdiff_t>(i) -
                        std::lower_bound(channel.times.begin(), channel.times.end(), channel.times[i]);
      const auto first = std::lower_bound(recorded->times.begin(), recorded->times.end(), channel.times[i]);
      const auto found = recorded->times.end() - first > rank ? first + rank : recorded->times.end();
      EXPECT_TRUE(found != recorded->times.end() && *found == channel.times[i])
          << channel.topic << " says something at " << channel.times[i] << " ns that was not recorded";
      if (found == recorded->times.end() || *found != channel.times[i]) return compared;
      const auto row = static_cast<std::size_t>(found - recorded->times.begin());
      bool same = true;
      if (!channel.columns.empty())
        same = std::equal(channel.row(i), channel.row(i) + channel.columns.size(), recorded->row(row));
      else
        same = *later.payload(channel, i) == *recording.payload(*recorded, row);
      EXPECT_TRUE(same) << channel.topic << " differs at " << channel.times[i] << " ns";
      if (!same) return compared;
      ++compared;
    }
  }
  return compared;
}

TEST_P(Checkpoints, LetAnotherProcessGoOnWithTheSameBits) {
  const fs::path file = fs::path(FIXTURES_DIR) / "scenarios" / (GetParam().name + ".yaml");
  auto scenario = Scenario::load(file);
  ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
  scenario->solver.method = GetParam().solver;
  scenario->duration = std::min(scenario->duration, 0.8);
  const auto run = record(*scenario, folder_ / "recording.mcap");
  ASSERT_TRUE(run.ok() && !run->failure) << to_string(run.ok() ? Diagnostics{*run->failure} : run.errors());
  const Trace recording = loaded("recording.mcap");
  const std::vector<std::uint64_t> hashes = recording.integers("state_hash");
  const TraceChannel& checkpoints = *recording.find_channel("/checkpoint");
  ASSERT_GE(checkpoints.messages(), 4u);

  const std::size_t last = checkpoints.messages() - 1;
  for (const std::size_t number : {std::size_t{1}, last / 2 + 1, last}) {
    const auto tick = static_cast<std::size_t>(
        std::llround(static_cast<double>(checkpoints.times[number]) * 1e-9 / scenario->time_step));
    const std::string solver = name_of(GetParam().solver);
    const std::string command = "'" PROBE "' go-on '" + file.string() + "' " + solver + " '" +
                                (folder_ / "later.mcap").string() + "' '" + (folder_ / "recording.mcap").string() +
                                "' " + std::to_string(tick);
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const Trace later = loaded("later.mcap");
    const std::vector<std::uint64_t> later_hashes = later.integers("state_hash");
    ASSERT_EQ(later_hashes.size(), hashes.size() - tick);
    const auto [at, other] = std::mismatch(later_hashes.begin(), later_hashes.end(), hashes.begin() + tick);
    EXPECT_EQ(at, later_hashes.end()) << "from tick " << tick << ", the states differ at tick "
                                      << tick + (at - later_hashes.begin());
    EXPECT_GT(expect_same_messages(recording, later), 0u);
  }
}

}  // namespace
}  // namespace rehearse
