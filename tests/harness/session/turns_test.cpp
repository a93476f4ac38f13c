// Threads of controllers take turns: the same order in each run, in the time of the simulation.
#include "runs.h"

#include <numeric>

#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Turns : public RunTest {
 protected:
  /// A controller of Threads.so, as an entry of `controllers:`.
  static std::string threads(const std::string& options, const std::string& more = "") {
    return "{name: C, library: Threads, options: \"" + options + "\"" + more + "}";
  }
  std::vector<double> commands(const Trace& trace) const { return trace.values("Rig/C/output/SHOULDER/u"); }
};

struct Guest {
  const char* name;
};

class ThreadedGuest : public Turns, public ::testing::WithParamInterface<Guest> {};

TEST_P(ThreadedGuest, GivesTheSameCommandsInEachRunAndInAReplay) {
  const std::string scenario = rig(threads(GetParam().name));
  const Trace first = record_run(scenario);
  EXPECT_THAT(said_by_controllers(first), IsEmpty());
  EXPECT_EQ(summary_.ticks, 20);
  for (int i = 0; i < 3; ++i) {
    const Trace again = record_run(scenario, "again.mcap");
    EXPECT_EQ(first.integers("output_hash"), again.integers("output_hash"));
  }
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_EQ(replayed->ticks, 20);
  EXPECT_EQ(replayed->ticks_different, 0);
}

constexpr Guest guests[] = {{"pool"},    {"planner"},  {"double_buffer"}, {"timer"},     {"async"},
                            {"jthread"}, {"latch"},    {"semaphores"},    {"once"},      {"locals"},
                            {"logger"},  {"rwlock"},   {"pipe"},          {"timerfd"},   {"atomic_wait"},
                            {"c11"},     {"executor"}, {"readers"},       {"contended"}, {"cancelled"}};
INSTANTIATE_TEST_SUITE_P(Of, ThreadedGuest, ::testing::ValuesIn(guests), test::by_name);

TEST_F(Turns, LeaveAPlanToTheNextTick) {
  const std::vector<double> plans = commands(record_run(rig(threads("planner"))));
  std::vector<double> each_tick(20);
  std::iota(each_tick.begin(), each_tick.end(), 0.0);
  EXPECT_EQ(plans, each_tick);
}

TEST_F(Turns, LetAThreadGoOnWhenSimulatedTimeIsThere) {
  const std::vector<double> counts = commands(record_run(rig(threads("timer"))));
  ASSERT_EQ(counts.size(), 20u);
  for (int tick = 0; tick < 20; ++tick) EXPECT_NEAR(counts[tick], tick < 1 ? 0 : (tick - 1) / 5, 1e-4) << tick;
}

TEST_F(Turns, LetATimerInADescriptorCountSimulatedTime) {
  const std::vector<double> counts = commands(record_run(rig(threads("timerfd"))));
  ASSERT_EQ(counts.size(), 20u);
  EXPECT_EQ(counts[19], 6.0);
}

TEST_F(Turns, ServeALockFirstComeFirstServed) {
  const std::vector<double> served = commands(record_run(rig(threads("contended"))));
  std::vector<double> expected;
  std::uint64_t order = 7;
  for (std::uint64_t tick = 0; tick < 20; ++tick) {
    if (tick >= 2) order = order * 31 + tick % 2 + 1;
    expected.push_back(static_cast<double>(order % 1000) * 1e-3);
  }
  EXPECT_EQ(served, expected);
}

TEST_F(Turns, LetAThreadGoOnAfterItsDelay) {
  const std::vector<double> plans = commands(record_run(rig(threads("planner", ", threads: {planner: 5 ms}"))));
  EXPECT_EQ(plans, (std::vector<double>{0, 0, 0, 0, 0, 0, 6, 6, 6, 6, 6, 6, 12, 12, 12, 12, 12, 12, 18, 18}));
}

TEST_F(Turns, NameAThreadThatHasADelayAndIsntThere) {
  const Trace trace = record_run(rig(threads("planner", ", threads: {planer: 5 ms}")));
  EXPECT_THAT(said_by_controllers(trace),
              ElementsAre("Rig/C: has no thread 'planer', for which `threads` states a delay; it has 'planner'"));
}

TEST_F(Turns, LeaveFreeThreadsToTheKernel) {
  const Trace trace = record_run(rig(threads("spin 5", ", threads: free")));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_THAT(said_by_controllers(trace),
              ElementsAre("Rig/C: leaves a thread running after stop(): Threads.so stays loaded"));
}

TEST_F(Turns, AreRefusedWithTheWordsThatTheyMayHave) {
  for (const char* wrong : {"sometimes", "{planner: soon}", "[free]"}) {
    write("wrong.yaml", rig(threads("planner", std::string(", threads: ") + wrong)));
    const auto scenario = Scenario::load(path("wrong.yaml"));
    ASSERT_FALSE(scenario.ok()) << wrong;
    EXPECT_THAT(to_string(scenario.errors()), HasSubstr(wrong[0] == '{' ? "planner is 'soon'" : "threads is"));
  }
}

TEST_F(Turns, EndADeadlockWithTheLinesOfItsThreads) {
  record_run(rig(threads("deadlock 7")));
  ASSERT_TRUE(summary_.failure);
  EXPECT_EQ(summary_.end, RunEnding::hung);
  EXPECT_THAT(summary_.failure->message,
              ::testing::MatchesRegex(
                  "controller 'Rig/C' never goes on, because its threads wait for each other; "
                  "threads.cpp:[0-9]+: the call itself waits for a mutex that 'worker' holds; "
                  "threads.cpp:[0-9]+: 'worker' waits for a mutex that the call itself holds in control.. at tick 7 "
                  ".0.007 s."));
}

TEST_F(Turns, EndAThreadThatSpinsWithItsLine) {
  record_run(rig(threads("spin 5")), "run.mcap", 0.5);
  ASSERT_TRUE(summary_.failure);
  EXPECT_EQ(summary_.end, RunEnding::hung);
  EXPECT_THAT(summary_.failure->message, HasSubstr("threads.cpp:"));
  EXPECT_THAT(summary_.failure->message,
              HasSubstr("controller 'Rig/C' started a thread that neither waited nor ended within the limit of the "
                        "call, so no other thread had a turn (threads: free lets it run beside the others) in "
                        "control() at tick 5"));
}

TEST_F(Turns, LeaveAThreadThatOutlivesStop) {
  const Trace trace = record_run(rig(threads("outliver"), "cameras: none\n", "2"));
  EXPECT_EQ(summary_.ticks, 2000);
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: leaves a thread running after stop(): Threads.so stays loaded"));
}

}  // namespace
}  // namespace rehearse
