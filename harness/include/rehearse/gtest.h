// Tests of controllers with GoogleTest. Such a test includes this header alone; C++17.
//
//   TEST(Walker, StopsBeforeTheEdge) {  // golden/Walker.StopsBeforeTheEdge.mcap
//     const rehearse::Trace trace = rehearse::record("scenarios/walk_to_edge.yaml");
//     EXPECT_LT(trace.last("Walker/BASE/position/x"), 0.95);  // [m], the table ends at 1.00
//     EXPECT_MATCHES_GOLDEN(trace);
//   }
//   TEST(Walker, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Walker.StopsBeforeTheEdge"); }
//
//   TEST(Walker, StandsStill) {  // golden/Walker.StandsStill.mcap
//     const rehearse::Trace trace = rehearse::record("scenarios/stand.yaml");
//     EXPECT_HOLDS(trace);       // the scenario's expectations
//     EXPECT_MATCHES_GOLDEN(trace, rehearse::Exact{}, rehearse::Near{"Walker/IMU/*", 1e-6}, rehearse::Until{2.0});
//   }
//
// Link the target Rehearse::gtest: it has a main() that pins the process, so that every machine computes the same bits.
// rehearse_add_controller_test(NAME SOURCES .. CONTROLLERS .. FIXTURES .. GOLDEN ..) does this. To set inputs by hand,
// without physics: controller_bench.h. To make and accept goldens: golden.h.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/controller_bench.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rehearse {

/// The folders that a test program reads and writes.
struct TestFolders {
  std::string fixtures;  // scenarios and models; REHEARSE_FIXTURES in the environment overrides it
  std::string golden;    // goldens; REHEARSE_GOLDEN_DIR overrides it
  /// Parent of traces/, which has the reports, and of goldens/pending/; REHEARSE_PENDING overrides the latter.
  std::string output;
  std::string controllers;  // libraries of controllers; searched after REHEARSE_CONTROLLER_PATH
};

/// Sets the folders of this program; rehearse_add_controller_test calls it. An empty member leaves the folder
/// unchanged: at first the working directory, and golden/ in it. Returns true, so that it can initialise a variable.
bool set_test_folders(const TestFolders& folders);

/// The folders in use, including overrides by the environment, except for controllers.
TestFolders test_folders();

/// A path in the fixtures folder; absolute paths are returned unchanged.
std::string fixture_path(const std::string& path);

// Further arguments of EXPECT_MATCHES_GOLDEN after the recording, in any order.

/// All bits must be equal, independent of the scenario's tolerances. A Near before or after it makes an exception.
struct Exact {};

/// The allowed difference of matching series from the golden: |x - g| <= max(atol, rtol * scale). It comes after the
/// rules of the scenario; the last rule that matches a series decides alone.
struct Near {
  std::string channel;  // a pattern, as SR1/*/q
  double atol = 0.0;    // in the unit of the series
  double rtol = 0.0;    // of the largest magnitude of the series in the golden
};

/// Values are compared up to this time, instead of the scenario's horizon.
struct Until {
  double time = 0.0;  // [s]
};

/// The part of the loop that is compared with the golden.
enum class Level {
  controller,  // the golden's inputs are fed to the controllers, without physics: their commands have equal bits
  plant,       // the golden's commands move the world, from checkpoint to checkpoint
  closed,      // the whole recording is compared
};

/// The levels to compare; without it closed alone. If closed differs, the other levels are run as well, to find the
/// faulty part.
struct Levels {
  /// In any order.
  Levels(std::initializer_list<Level> wanted) : levels(wanted) {}
  std::vector<Level> levels;  // to compare
};

/// The cases of a test with variations (sweep).
struct SweepCases {
  std::int64_t cases = 100;  // number of variations
  std::uint64_t seed = 0;    // of their values
  int jobs = 0;              // worker processes; 0: one for each processor
  double case_limit = 60.0;  // wall time of a case; a longer one counts as hung [s]
};

/// The results of a test with variations.
struct SweepResult {
  std::int64_t cases = 0;   // cases with a result
  std::int64_t passed = 0;  // cases that passed
  double low = 0.0;         // lower bound of the share that passes: the exact interval with 95 % confidence
  double high = 1.0;        // its upper bound
  std::string verdict;      // a sentence: "197 of 200 cases pass: ..."
  std::string failures;     // the kinds of failures, a line each, with the command that makes the first case again
  bool repeats = true;      // cases that ran twice gave the same bits
  bool passes = true;       // the scenario's `pass_rate` holds; without one every case passes
  bool undecided = false;   // more cases are needed to know whether it holds
  std::vector<std::string> never_tried;  // states of the scenario's `sometimes` that no case reached
  /// The failures that the project keeps and that fail again, a line each: "failures/a.yaml: violated: ...".
  std::vector<std::string> failing_again;
  std::string folder;  // of the campaign, with its report
};

namespace internal {

struct TestVerdict {
  bool passed = false;
  std::string message;  // why it did not pass
};

/// All options of EXPECT_MATCHES_GOLDEN.
struct MatchOptions {
  bool exact = false;
  std::vector<Near> near;
  std::optional<double> until;  // [s]
  std::vector<Level> levels{Level::closed};
  std::string source = {};  // of the test, as it was compiled; empty: unknown
};

inline void set_option(MatchOptions& options, Exact) { options.exact = true; }
inline void set_option(MatchOptions& options, const Near& near) { options.near.push_back(near); }
inline void set_option(MatchOptions& options, Until until) { options.until = until.time; }
inline void set_option(MatchOptions& options, const Levels& levels) { options.levels = levels.levels; }
template <class Other>
void set_option(MatchOptions&, const Other&) {
  static_assert(
      sizeof(Other) == 0,
      "EXPECT_MATCHES_GOLDEN takes Exact, Near, Until or Levels after the recording. The test names the golden: "
      "golden/Suite.Test.mcap");
}

// `test` is Suite.Test.
Trace record_for_test(const std::string& scenario, const std::string& test);
TestVerdict match_golden(const Trace& trace, const std::string& test, const MatchOptions& options = {});
TestVerdict hold_expectations(const Trace& trace, const std::string& test);
TestVerdict replay_golden(const std::string& name, const std::string& test);
TestVerdict try_orders_of_golden(const std::string& name, int orders, const std::string& test);
SweepResult sweep_for_test(const std::string& scenario, const SweepCases& cases, const std::string& test);
TestVerdict judge_pass_rate(const SweepResult& result, double rate);
TestVerdict judge_claims(const SweepResult& result);
TestVerdict judge_realtime(const Trace& trace);
TestVerdict judge_realtime(const ControllerBench& bench);

/// The result of a call; its std::runtime_error begins with the place of the call.
template <class Call>
auto called_from(const CallPlace& from, const Call& call) {
  try {
    return call();
  } catch (const std::runtime_error& failure) {
    throw std::runtime_error(message_at(from, failure.what()));
  }
}

/// Suite.Test of the running test; the slashes of parameterised and typed tests become dashes.
inline std::string current_test() {
  const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = info ? std::string(info->test_suite_name()) + "." + info->name() : "NoTest.Runs";
  for (char& letter : name)
    if (letter == '/') letter = '-';
  return name;
}

/// The source of the running test; empty: none runs.
inline std::string current_source() {
  const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
  return info && info->file() ? info->file() : "";
}

inline ::testing::AssertionResult assertion_of(const TestVerdict& verdict) {
  return verdict.passed ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << verdict.message;
}

/// A recording, and the options of its comparison.
struct GoldenQuestion {
  const Trace& trace;
  MatchOptions options;
};

template <class... Overrides>
GoldenQuestion golden_question(const Trace& trace, const Overrides&... overrides) {
  GoldenQuestion question{trace, {}};
  question.options.source = current_source();
  (set_option(question.options, overrides), ...);
  return question;
}

inline ::testing::AssertionResult MatchesGolden(const char*, const GoldenQuestion& question) {
  return assertion_of(match_golden(question.trace, current_test(), question.options));
}

inline ::testing::AssertionResult Holds(const char*, const Trace& trace) {
  return assertion_of(hold_expectations(trace, current_test()));
}

inline ::testing::AssertionResult HasPassRate(const char*, const char*, const SweepResult& result, double rate) {
  return assertion_of(judge_pass_rate(result, rate));
}

inline ::testing::AssertionResult HoldsItsClaims(const char*, const SweepResult& result) {
  return assertion_of(judge_claims(result));
}

template <class Run>
::testing::AssertionResult IsRealtime(const char*, const Run& run) {
  return assertion_of(judge_realtime(run));
}

inline ::testing::AssertionResult Replays(const char*, const std::string& name) {
  return assertion_of(replay_golden(name, current_test()));
}

inline ::testing::AssertionResult IsSameInAllOrders(const char*, const char*, const std::string& name, int orders) {
  return assertion_of(try_orders_of_golden(name, orders, current_test()));
}

#ifdef REHEARSE_TEST_FIXTURES
inline const bool folders_are_set =
    set_test_folders({REHEARSE_TEST_FIXTURES, REHEARSE_TEST_GOLDEN, REHEARSE_TEST_OUTPUT, REHEARSE_TEST_CONTROLLERS});
#endif

}  // namespace internal

/// Runs a scenario (a path in the fixtures) in simulation and returns its recording, which is kept as
/// traces/Suite.Test.mcap in the test's output folder. Throws std::runtime_error, which fails the test, if the run
/// can't begin, or if a controller refused, threw, crashed or hung in it. The text is the message of `rehearse record`.
/// If the run is proved to be golden/Suite.Test.mcap, bit for bit, the controllers run on its inputs and nothing is
/// simulated. The recording is then a copy of the golden (check.h: Proof). REHEARSE_PROOF=off simulates always.
inline Trace record(const std::string& scenario, const CallPlace& from = CallPlace::here()) {
  return internal::called_from(from, [&] { return internal::record_for_test(scenario, internal::current_test()); });
}

/// Runs variations of a scenario (`vary:`, campaign.h) in processes of their own, and judges each by the scenario's
/// expectations. The campaign is kept as campaigns/Suite.Test in the test's output folder, with a report. Throws
/// std::runtime_error, which fails the test, if the campaign can't run. The failures that the project keeps run first.
/// A case of one simulated second of a humanoid takes about 0.15 s: state `cases` so that the test ends within the time
/// of ctest.
inline SweepResult sweep(const std::string& scenario, const SweepCases& cases = {},
                         const CallPlace& from = CallPlace::here()) {
  return internal::called_from(from,
                               [&] { return internal::sweep_for_test(scenario, cases, internal::current_test()); });
}

}  // namespace rehearse

/// Passes unless the share of cases that pass is below `rate`, 0 to 1, with 95 % confidence. It fails if even the upper
/// bound of the exact interval is below the rate, if a case that ran twice gave different bits, if a failure that the
/// project keeps fails again, or if no case reached a
/// state of the scenario's `sometimes`. So a few failures in a few cases don't fail it by chance. The message states
/// the interval and the failing cases. A `pass_rate` of the scenario isn't asked: EXPECT_SWEEP_PASSES.
#define EXPECT_PASS_RATE(result, rate) EXPECT_PRED_FORMAT2(::rehearse::internal::HasPassRate, result, rate)
#define ASSERT_PASS_RATE(result, rate) ASSERT_PRED_FORMAT2(::rehearse::internal::HasPassRate, result, rate)

/// Passes if what the scenario claims of its campaigns holds: its `pass_rate` (without one, that every case passes) and
/// its `sometimes`. It fails, too, if there are too few cases to decide the pass rate: the message states how many
/// would.
#define EXPECT_SWEEP_PASSES(result) EXPECT_PRED_FORMAT1(::rehearse::internal::HoldsItsClaims, result)
#define ASSERT_SWEEP_PASSES(result) ASSERT_PRED_FORMAT1(::rehearse::internal::HoldsItsClaims, result)

/// Passes if the recording agrees with golden/Suite.Test.mcap within the tolerances of its scenario and up to its
/// horizon. The expectations of the scenario must be met, too. More arguments change this: Exact{}, Near{"SR1/*/q",
/// 1e-6}, Until{2.0}, Levels{Level::controller, ...}. With REHEARSE_GOLDEN=new and =accept the golden
/// is written instead. The failure message states the place and size of the first difference, and the responsible part
/// of the loop.
#define EXPECT_MATCHES_GOLDEN(...) \
  EXPECT_PRED_FORMAT1(::rehearse::internal::MatchesGolden, ::rehearse::internal::golden_question(__VA_ARGS__))
#define ASSERT_MATCHES_GOLDEN(...) \
  ASSERT_PRED_FORMAT1(::rehearse::internal::MatchesGolden, ::rehearse::internal::golden_question(__VA_ARGS__))

/// Passes if the expectations of the recording's scenario (`expect:`) are met. Needs no golden.
#define EXPECT_HOLDS(trace) EXPECT_PRED_FORMAT1(::rehearse::internal::Holds, trace)
#define ASSERT_HOLDS(trace) ASSERT_PRED_FORMAT1(::rehearse::internal::Holds, trace)

/// Passes if control() neither allocates nor releases memory, takes no lock, calls no function of the C library that
/// calls the system and throws nothing, in all ticks after the first. `run`: a ControllerBench, or a recording of a
/// scenario with `realtime: counts`. With REHEARSE_REALTIME=1 in the environment each run of the program counts.
#define EXPECT_REALTIME(run) EXPECT_PRED_FORMAT1(::rehearse::internal::IsRealtime, run)
#define ASSERT_REALTIME(run) ASSERT_PRED_FORMAT1(::rehearse::internal::IsRealtime, run)

/// Passes if the controllers give the same commands, bit for bit, for the inputs in golden/NAME.mcap, without physics.
/// Of a robot's flight (`rehearse golden accept NAME --recording flight.mcap`) commands within their tolerances pass
/// too, if the robot's processor or C library rounds differently.
#define EXPECT_REPLAYS(name) EXPECT_PRED_FORMAT1(::rehearse::internal::Replays, name)
#define ASSERT_REPLAYS(name) ASSERT_PRED_FORMAT1(::rehearse::internal::Replays, name)

/// Passes if the controllers of golden/NAME.mcap give the same commands, bit for bit, in `orders` other orders of their
/// threads, on its inputs. Each order is replayed in a process of its own. It fails if no thread can come before
/// another one, as nothing is compared then. The message states the first difference, and the threads and lines that
/// exchange their turns; `rehearse replay` repeats the order from traces/Suite.Test.order.json. The probability with
/// which so many orders find a difference: `rehearse audit golden/NAME.mcap --orders N`.
#define EXPECT_SAME_IN_ALL_ORDERS(name, orders) \
  EXPECT_PRED_FORMAT2(::rehearse::internal::IsSameInAllOrders, name, orders)
#define ASSERT_SAME_IN_ALL_ORDERS(name, orders) \
  ASSERT_PRED_FORMAT2(::rehearse::internal::IsSameInAllOrders, name, orders)
