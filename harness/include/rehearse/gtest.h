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
//     EXPECT_HOLDS(trace);       // what the scenario expects of a run
//     EXPECT_MATCHES_GOLDEN(trace, rehearse::Exact{}, rehearse::Near{"Walker/IMU/*", 1e-6}, rehearse::Until{2.0});
//   }
//
// Link the target Rehearse::gtest: it has a main() that pins the process, so that every machine computes the same bits.
// rehearse_add_controller_test(NAME SOURCES .. CONTROLLERS .. FIXTURES .. GOLDEN ..) does this. To set inputs by hand,
// without physics: controller_bench.h. To make and accept goldens: golden.h.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/controller_bench.h>
#include <rehearse/test_support.h>
#include <rehearse/trace.h>

#include <string>

namespace rehearse {
namespace internal {

/// Suite.Test of the running test; the slashes of parameterised and typed tests become dashes.
inline std::string current_test() {
  const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = info ? std::string(info->test_suite_name()) + "." + info->name() : "NoTest.Runs";
  for (char& letter : name)
    if (letter == '/') letter = '-';
  return name;
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
  (take(question.options, overrides), ...);
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

inline ::testing::AssertionResult Replays(const char*, const std::string& name) {
  return assertion_of(replay_golden(name, current_test()));
}

#ifdef REHEARSE_TEST_FIXTURES
inline const bool folders_are_set =
    set_test_folders({REHEARSE_TEST_FIXTURES, REHEARSE_TEST_GOLDEN, REHEARSE_TEST_OUTPUT, REHEARSE_TEST_CONTROLLERS});
#endif

}  // namespace internal

/// Runs a scenario (a path in the fixtures) in simulation and returns its recording, which is kept as
/// traces/Suite.Test.mcap in the test's output folder. Throws std::runtime_error, which fails the test, if the run
/// can't begin, or if a controller refused, threw, crashed or hung in it. The text is the message of `rehearse record`.
/// If it is proved that the run is golden/Suite.Test.mcap, bit for bit, the controllers run on its inputs, nothing is
/// simulated, and the recording is a copy of the golden (check.h: Proof). REHEARSE_PROOF=off simulates always.
inline Trace record(const std::string& scenario) {
  return internal::record_for_test(scenario, internal::current_test());
}

/// Runs variations of a scenario (`vary:`, campaign.h) in processes of their own, and judges each by the scenario's
/// expectations. The campaign is kept as campaigns/Suite.Test in the test's output folder, with a report. Throws
/// std::runtime_error, which fails the test, if the campaign can't run. A case of one simulated second of a humanoid
/// takes about 0.15 s: state `cases` so that the test ends within the time of ctest.
inline SweepResult sweep(const std::string& scenario, const SweepCases& cases = {}) {
  return internal::sweep_for_test(scenario, cases, internal::current_test());
}

}  // namespace rehearse

/// Passes unless the share of cases that pass is below `rate`, 0 to 1, with 95 % confidence: it fails if even the upper
/// bound of Wilson's interval is below the rate, or if a case that ran twice gave different bits. So a few failures in
/// a few cases don't fail it by chance. The message states the interval and the failing cases.
#define EXPECT_PASS_RATE(result, rate) EXPECT_PRED_FORMAT2(::rehearse::internal::HasPassRate, result, rate)
#define ASSERT_PASS_RATE(result, rate) ASSERT_PRED_FORMAT2(::rehearse::internal::HasPassRate, result, rate)

/// Passes if the recording agrees with golden/Suite.Test.mcap within the tolerances of its scenario and up to its
/// horizon. The expectations of the scenario must hold, too. More arguments change this: Exact{}, Near{"SR1/*/q",
/// 1e-6}, Until{2.0}, Levels{Level::controller, ...} (test_support.h). With REHEARSE_GOLDEN=new and =accept the golden
/// is written instead. The failure message states the place and size of the first difference, and the responsible part
/// of the loop.
#define EXPECT_MATCHES_GOLDEN(...) \
  EXPECT_PRED_FORMAT1(::rehearse::internal::MatchesGolden, ::rehearse::internal::golden_question(__VA_ARGS__))
#define ASSERT_MATCHES_GOLDEN(...) \
  ASSERT_PRED_FORMAT1(::rehearse::internal::MatchesGolden, ::rehearse::internal::golden_question(__VA_ARGS__))

/// Passes if the expectations of the recording's scenario (`expect:`) hold. Needs no golden.
#define EXPECT_HOLDS(trace) EXPECT_PRED_FORMAT1(::rehearse::internal::Holds, trace)
#define ASSERT_HOLDS(trace) ASSERT_PRED_FORMAT1(::rehearse::internal::Holds, trace)

/// Passes if the controllers give the same commands, bit for bit, for the inputs in golden/NAME.mcap, without physics.
#define EXPECT_REPLAYS(name) EXPECT_PRED_FORMAT1(::rehearse::internal::Replays, name)
#define ASSERT_REPLAYS(name) ASSERT_PRED_FORMAT1(::rehearse::internal::Replays, name)
