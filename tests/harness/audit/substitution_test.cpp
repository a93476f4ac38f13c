// The simulated time and seeded numbers that a controller gets instead of the system's.
#include <set>
#include <thread>

#include "watched_runs.h"

namespace rehearse {
namespace {

using ::testing::Each;
using ::testing::Ne;

using SimulatedTime = WatchedTest;
using SeededNumbers = WatchedTest;

TEST_F(SimulatedTime, IsTheTicks) {
  const std::vector<double> uptime = run("read_steady_clock", 3, substituted()).values;
  ASSERT_EQ(uptime.size(), 3u);
  for (int tick = 0; tick < 3; ++tick) EXPECT_NEAR(uptime[tick], 1000.0 + 0.001 * tick, 1e-8);
  EXPECT_THAT(run("read_time", 3, substituted()).values, Each(1767225600.0));
  EXPECT_NEAR(run("read_system_clock", 3, substituted()).values[2], 1767225600.002, 1e-6);
  EXPECT_NEAR(run("read_gettimeofday", 3, substituted()).values[2], 1767225600.002, 1e-6);
  EXPECT_NEAR(run("read_processor_time", 3, substituted()).values[2], 2000.0, 1.0);  // [us]
}

TEST_F(SimulatedTime, PassesALittleWithEachReading) {
  EXPECT_THAT(run("read_twice", 3, substituted()).values, Each(::testing::DoubleNear(1e-9, 2e-13)));
  const double rounds = run("spin_for_a_millisecond", 1, substituted()).values.at(0);
  EXPECT_EQ(rounds, 99'999.0);
}

TEST_F(SimulatedTime, IsNotSlept) {
  const auto before = std::chrono::steady_clock::now();
  EXPECT_THAT(run("sleep_an_hour", 3, substituted()).values, Each(::testing::DoubleNear(3600.0, 1e-6)));
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(30));
}

TEST_F(SimulatedTime, ReachesTheDeadlineThatWasWaitedForInVain) {
  EXPECT_THAT(run("wait_in_vain", 3, substituted()).values, Each(::testing::DoubleNear(0.02, 1e-6)));
}

TEST_F(SimulatedTime, CanBeAnother) {
  Substitution other = substituted();
  other.clock = other.clock->shifted();
  const std::vector<double> values = run("read_system_clock", 101, other).values;
  ASSERT_EQ(values.size(), 101u);
  EXPECT_GT(values[0], 1767225600.0 + 399 * 86400.0);
  EXPECT_NEAR(values[100] - values[0], 0.3, 1e-6);
}

TEST_F(SimulatedTime, IsTheSameInEachRun) {
  EXPECT_EQ(run("read_steady_clock", 50, substituted()).values, run("read_steady_clock", 50, substituted()).values);
}

class SeededSource : public WatchedTest, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Each, SeededSource,
                         ::testing::Values("draw_rand", "draw_drand48", "draw_random_device", "draw_getrandom",
                                           "draw_urandom"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(SeededSource, GivesWhatTheSeedSays) {
  const std::vector<double> values = run(GetParam(), 20, substituted(1)).values;
  EXPECT_EQ(run(GetParam(), 20, substituted(1)).values, values);
  EXPECT_NE(run(GetParam(), 20, substituted(2)).values, values);
  EXPECT_EQ(std::set<double>(values.begin(), values.end()).size(), 20u);
  EXPECT_THAT(values, Each(::testing::Ge(0.0)));
}

TEST_F(SeededNumbers, FollowTheSeedThatAControllerSetsItself) {
  for (const char* function : {"draw_seeded_rand", "draw_seeded_drand48"}) {
    const std::vector<double> values = run(function, 20, substituted(1)).values;
    EXPECT_EQ(run(function, 20, substituted(2)).values, values) << function;
  }
}

TEST_F(SeededNumbers, ChangeAtOnePlaceAlone) {
  InterposerSettings settings;
  settings.everywhere = substituted(1);
  const WatchedRun base = run("draw_at_two_places", 1, settings);
  const auto calls = base.calls_of("rand");
  ASSERT_EQ(calls.size(), 2u);
  settings.there = substituted(2);
  const auto first_of = [](double sum) { return std::floor(sum); };
  settings.only = calls[0].place;
  const double other_first = run("draw_at_two_places", 1, settings).values.at(0);
  settings.only = calls[1].place;
  const double other_second = run("draw_at_two_places", 1, settings).values.at(0);
  EXPECT_NE(first_of(other_first), first_of(base.values[0]));
  EXPECT_EQ(first_of(other_second), first_of(base.values[0]));
  EXPECT_NE(other_second, base.values[0]);
}

TEST_F(WatchedTest, SystemCallsPastTheCLibraryAreNotedAndAnswered) {
  for (const char* function : {"draw_past_the_c_library", "block_all_signals_and_draw"}) {
    const WatchedRun seen = run(function, 20, substituted(1));
    EXPECT_EQ(seen.values.size(), 20u) << function;
    EXPECT_EQ(run(function, 20, substituted(1)).values, seen.values) << function;
    EXPECT_NE(run(function, 20, substituted(2)).values, seen.values) << function;
    const ObservedCall call = seen.call_of("getrandom");
    EXPECT_EQ(call.source, ObservedCall::Source::random);
    EXPECT_EQ(call.last_tick, 19);
    EXPECT_NE(place_of(call).find("(watched.cpp:"), std::string::npos) << place_of(call);
    EXPECT_FALSE(seen.log.hidden_calls);
  }
}

TEST_F(WatchedTest, AnImaginaryMachineHasItsOwnProcessors) {
  Substitution small, large;
  small.machine = 2;
  large.machine = 3;
  EXPECT_THAT(run("ask_for_processors", 2, small).values, Each(1.0));
  EXPECT_THAT(run("ask_for_processors", 2, large).values, Each(24.0));
  EXPECT_THAT(run("ask_for_processors", 2).values, Each(static_cast<double>(std::thread::hardware_concurrency())));
}

TEST_F(WatchedTest, AProcessWritesIntoItsOwnCopiesOfFiles) {
  write("count.txt", "6\n");
  InterposerSettings settings;
  for (const char* copies : {"first", "second"}) {
    settings.files = folder_ / copies;
    EXPECT_EQ(run("count_in_a_file", 3, settings).values, (std::vector{7.0, 8.0, 9.0}));
  }
  EXPECT_EQ(run("count_in_a_file", 1).values, std::vector{7.0});  // the file itself was left alone
}

TEST_F(WatchedTest, AFolderIsListedAsTheProcessHasChangedIt) {
  write("gains.txt", "1\n");
  write("kept.txt", "1\n");
  InterposerSettings settings;
  settings.files = folder_ / "copies";
  EXPECT_EQ(run("list_what_it_made", 2, settings).values, (std::vector{101.0, 101.0}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "gains.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made.txt"));
}

TEST_F(WatchedTest, ThreadSchedulesAndASlowHostDelayReally) {
  const auto lasts = [&](const Substitution& substitution) {
    const auto before = std::chrono::steady_clock::now();
    EXPECT_THAT(run("start_a_thread", 100, substitution).values, Each(Ne(0.0)));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  };
  Substitution late;
  late.threads = ThreadSchedule::late;
  EXPECT_GT(lasts(late), 0.3);
  Substitution early;
  early.threads = ThreadSchedule::early;
  EXPECT_GT(lasts(early), 0.3);
  Substitution slow;
  slow.slow = 3000;
  EXPECT_GT(lasts(slow), 0.3);
}

}  // namespace
}  // namespace rehearse
