// The cost of expectations: twenty conditions over time, judged on a recording.

#include <rehearse/check.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <array>

#include "core/scenario/declared_source.h"
#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

/// Ten conditions of one tick, and ten with windows.
std::vector<Expectation> twenty_expectations(const Scenario& scenario) {
  constexpr std::array<const char*, 10> conditions{"abs(SR1/WAIST/pitch) < 80 deg",
                                                   "SR1/WAIST/z > 0.1 m",
                                                   "abs(u(RLEG_KNEE)) < 3000 N·m",
                                                   "abs(q(LLEG_KNEE) - q(RLEG_KNEE)) < 3",
                                                   "abs(delta(q(RLEG_HIP_P))) < 1 || tick == 0",
                                                   "max(dq(RARM_ELBOW), dq(LARM_ELBOW)) < 100",
                                                   "SR1/WAIST/linear/x < 10 m/s && SR1/WAIST/linear/y < 10 m/s",
                                                   "contact(RLEG_ANKLE_R) || contact(LLEG_ANKLE_R) || time < 60",
                                                   "sqrt(SR1/WAIST/x * SR1/WAIST/x + SR1/WAIST/y * SR1/WAIST/y) < 9",
                                                   "abs(q(CHEST)) < 90 deg"};
  std::vector<Expectation> expectations;
  for (std::size_t i = 0; i < 2 * conditions.size(); ++i) {
    Expectation& expectation = expectations.emplace_back();
    expectation.subject = Expectation::Subject::expression;
    expectation.expression = conditions[i % conditions.size()];
    if (i >= conditions.size()) {
      expectation.after = "step(u(RLEG_KNEE), 1)";
      expectation.delay = 0.5;
      expectation.until = 59.0;
    }
    if (!declare_expressions(scenario, expectation).empty()) std::abort();
  }
  return expectations;
}

/// Work: twenty expectations over a minute of SR1. Base: Trace::load() of it. At most 2.
void expectations_over_reading(benchmark::State& state) {
  Scenario scenario = Sr1Run::instance().scenario();
  scenario.duration = 60.0;  // [s]
  const std::filesystem::path file = Sr1Run::instance().folder() / "judged_minute.mcap";
  must(record(scenario, file));
  const std::vector<Expectation> expectations = twenty_expectations(scenario);
  for (const ExpectationResult& result : must(judge_expectations(expectations, file)))
    if (!result.holds) state.SkipWithError(result.sentence.c_str());
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(
        pairs.measure([&] { benchmark::DoNotOptimize(must(judge_expectations(expectations, file)).size()); },
                      [&] { benchmark::DoNotOptimize(must(Trace::load(file)).ticks()); }));
  pairs.report(state, 1.0, 1.0);
}
BENCHMARK(expectations_over_reading)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
