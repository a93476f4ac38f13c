// The loop of all runs, with parts that only record their calls.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/guard/interruption.h"
#include "core/run/run.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

struct Parts final : ObservationSource, Commander, Sink {
  std::vector<std::string> calls;
  std::int64_t ticks = 100;       // number of available ticks
  std::int64_t breaks_down = -1;  // in the step after this tick
  std::int64_t fails = -1;        // the controller, at this tick
  bool throws = false;
  bool is_full = false;

  void note(const char* what, const TickData& now) { calls.push_back(what + std::to_string(now.tick)); }
  Result<bool> observe(TickData& now) override {
    if (throws) throw std::invalid_argument("a test's mistake");
    note(now.is_closing ? "closing " : "observe ", now);
    return now.is_closing || now.tick < ticks;
  }
  void act(TickData& now) override {
    note("command ", now);
    now.alive = now.tick != fails;
  }
  void act_late(TickData& now) override { note("late ", now); }
  Result<void> emit(const TickData& now) override {
    note("emit ", now);
    return is_full ? Result<void>(error("the disk is full")) : Result<void>();
  }
  Result<bool> advance(TickData& now, Commander& commands) override {
    note("advance ", now);
    commands.act_late(now);
    return now.tick != breaks_down;
  }
};

TEST(RunTest, ObservesCommandsEmitsAndAdvancesInEachTick) {
  Parts parts;
  rehearse::Run two(0.001, parts, parts, parts, 3, 5);
  ASSERT_TRUE(two.go().ok());
  ASSERT_TRUE(two.close().ok());
  EXPECT_EQ(two.tick(), 5);
  EXPECT_THAT(parts.calls, ElementsAre("observe 3", "command 3", "emit 3", "advance 3", "late 3", "observe 4",
                                       "command 4", "emit 4", "advance 4", "late 4", "closing 5", "emit 5"));
}

TEST(RunTest, EndsWithItsSource) {
  Parts parts;
  parts.ticks = 1;
  rehearse::Run all(0.001, parts, parts, parts, 0, rehearse::Run::no_end);
  ASSERT_TRUE(all.go().ok());
  EXPECT_EQ(all.tick(), 1);
  EXPECT_EQ(parts.calls.back(), "observe 1");
}

TEST(RunTest, EmitsTheTickInWhichAControllerFailsAndAdvancesNoFurther) {
  Parts parts;
  parts.fails = 0;
  rehearse::Run failing(0.001, parts, parts, parts, 0, 5);
  ASSERT_TRUE(failing.go().ok());
  EXPECT_EQ(failing.tick(), 0);
  EXPECT_THAT(parts.calls, ElementsAre("observe 0", "command 0", "emit 0"));
}

TEST(RunTest, MakesNoTickAfterTheStepInWhichItsSourceBreaksDown) {
  Parts parts;
  parts.breaks_down = 1;
  rehearse::Run exploding(0.001, parts, parts, parts, 0, 5);
  ASSERT_TRUE(exploding.go().ok());
  EXPECT_TRUE(exploding.broke_down());
  EXPECT_EQ(exploding.tick(), 2);
  EXPECT_EQ(parts.calls.back(), "late 1");
}

TEST(RunTest, FailsWithItsSink) {
  Parts parts;
  parts.is_full = true;
  rehearse::Run full(0.001, parts, parts, parts, 0, 5);
  const auto step = full.step();
  ASSERT_FALSE(step.ok());
  EXPECT_EQ(step.errors()[0].message, "the disk is full");
  EXPECT_EQ(parts.calls.back(), "emit 0");
}

TEST(RunTest, RepeatsATickThatWasNotObserved) {
  Parts parts;
  rehearse::Run bench(0.001, parts, parts, parts, 0, 5);
  parts.throws = true;
  EXPECT_THROW((void)bench.step(), std::invalid_argument);
  parts.throws = false;
  EXPECT_TRUE(*bench.step());
  EXPECT_EQ(parts.calls[0], "observe 0");
}

TEST(RunTest, GoesOnFromAnotherSource) {
  Parts parts;
  Parts other;
  rehearse::Run branch(0.001, parts, parts, parts, 0, 2);
  ASSERT_TRUE(branch.go().ok());
  branch.change(other, other, 3);
  ASSERT_TRUE(branch.go().ok());
  EXPECT_THAT(other.calls, ElementsAre("observe 2", "emit 2", "advance 2"));
  EXPECT_EQ(parts.calls.back(), "late 2") << "the commands come from where they came from";
}

TEST(RunTest, ReportsEachHundredthOfItsProgress) {
  Parts parts;
  std::vector<std::pair<std::int64_t, std::int64_t>> reported;
  rehearse::Run long_run(0.001, parts, parts, parts, 7, 7 + 250);
  parts.ticks = 1000;
  long_run.report_progress([&](std::int64_t done, std::int64_t all) { reported.push_back({done, all}); }, 250);
  ASSERT_TRUE(long_run.go().ok());
  EXPECT_EQ(reported.size(), 125u);
  EXPECT_THAT(reported[0], Pair(2, 250));
  EXPECT_THAT(reported.back(), Pair(250, 250));
}

/// Runs in a separate process, because a received signal is remembered. A child sends the signal.
[[noreturn]] void step_until_interrupted(Run& run, const Parts& parts) {
  end_runs_on_signals();
  const bool stepped = *run.step();
  if (fork() == 0) {
    kill(getppid(), SIGINT);
    _exit(0);
  }
  while (interruption() == 0) usleep(1000);
  const bool ended = !*run.step() && !*run.step() && run.tick() == 1;
  const std::string text = run.interruption() ? run.interruption()->message : "it goes on";
  fprintf(stderr, "%s, %s\n", text.c_str(), parts.calls.back().c_str());
  _exit(stepped && ended ? 0 : 1);
}

TEST(RunTest, EndsBeforeTheTickInWhichASignalFoundIt) {
  Parts parts;
  rehearse::Run interrupted(0.001, parts, parts, parts, 0, 5);
  EXPECT_EXIT(step_until_interrupted(interrupted, parts), ::testing::ExitedWithCode(0),
              "interrupted by SIGINT before tick 1 .*observe 1");
}

}  // namespace
}  // namespace rehearse
