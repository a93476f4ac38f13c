// EXPECT_REALTIME and REHEARSE_REALTIME.
#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <rehearse/gtest.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "session/runs.h"

namespace {

using rehearse::ControllerBench;
using ::testing::HasSubstr;

class RealtimeAssertions : public rehearse::RunTest {
 protected:
  RealtimeAssertions() {
    unsetenv("REHEARSE_REALTIME");
    rehearse::set_test_folders({path("").string(), path("golden").string(), path("").string(), ""});
  }
  ~RealtimeAssertions() override { unsetenv("REHEARSE_REALTIME"); }

  rehearse::Trace recording_of(const std::string& words, const std::string& more) const {
    write("run.yaml", rig(behaviour("C", words), "cameras: none\n" + more));
    return rehearse::record("run.yaml");
  }

  std::unique_ptr<ControllerBench> bench_of(const std::string& words) const {
    rehearse::BenchOptions options;
    options.options = words;
    return std::make_unique<ControllerBench>("Behaviours", path("rig.urdf").string(), options);
  }
};

TEST_F(RealtimeAssertions, CountTheCostsOfATick) {
  const auto bench = bench_of("allocate 2");
  bench->tick();
  EXPECT_EQ(bench->cost("allocations"), 0u);
  for (int i = 0; i < 2; ++i) bench->tick();
  EXPECT_EQ(bench->cost("allocations"), 1u);
  EXPECT_EQ(bench->cost("allocated_bytes"), 1000u);
  EXPECT_EQ(bench->cost("releases"), 1u);
  EXPECT_THROW(bench->cost("time"), std::out_of_range);
}

TEST_F(RealtimeAssertions, FailWithTheCountsAndTheFirstTick) {
  const auto bench = bench_of("allocate 2");
  for (int i = 0; i < 2; ++i) bench->tick();
  EXPECT_REALTIME(*bench);
  for (int i = 0; i < 3; ++i) bench->tick();
  const auto judged = rehearse::internal::IsRealtime("", *bench);
  EXPECT_FALSE(judged);
  EXPECT_THAT(judged.message(),
              HasSubstr("isn't real-time safe: 3 allocations in 3 ticks, first at tick 2; 3 releases of memory in 3 "
                        "ticks, first at tick 2"));
}

TEST_F(RealtimeAssertions, LeaveOutTheFirstTick) {
  const auto bench = bench_of("allocate 0");
  bench->tick();
  ASSERT_REALTIME(*bench);
}

TEST_F(RealtimeAssertions, JudgeARecordingThatHasCosts) {
  const rehearse::Trace trace = recording_of("allocate 3", "realtime: counts\n");
  const auto judged = rehearse::internal::IsRealtime("", trace);
  EXPECT_FALSE(judged);
  EXPECT_THAT(judged.message(), HasSubstr("17 allocations in 17 ticks, first at tick 3"));
  EXPECT_THAT(judged.message(), HasSubstr("rehearse audit --realtime"));
  EXPECT_REALTIME(recording_of("allocate 30", "realtime: counts\n"));
}

TEST_F(RealtimeAssertions, DemandCosts) {
  const auto judged = rehearse::internal::IsRealtime("", recording_of("allocate 30", ""));
  EXPECT_FALSE(judged);
  EXPECT_THAT(judged.message(), HasSubstr("has no costs of control(): the scenario needs `realtime: counts`"));
}

TEST_F(RealtimeAssertions, HoldForAWholeProgramByTheEnvironment) {
  setenv("REHEARSE_REALTIME", "1", 1);
  EXPECT_REALTIME(recording_of("allocate 30", ""));
  EXPECT_THROW(recording_of("allocate 3", ""), std::runtime_error);
  const auto bench = bench_of("allocate 1");
  bench->tick();
  EXPECT_THROW(bench->tick(), std::runtime_error);
}

}  // namespace
