// The cost of comparing two traces relative to reading them.

#include <rehearse/compare.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr double minute = 60.0;  // [s]

/// A minute of SR1, and the same with another seed of the physics, so that nearly every number differs.
class TwoMinutes {
 public:
  TwoMinutes() {
    Scenario scenario = Sr1Run::instance().scenario();
    scenario.duration = minute;
    must(record(scenario, golden));
    scenario.seed += 1;
    must(record(scenario, other));
  }
  const std::filesystem::path golden = Sr1Run::instance().folder() / "golden_minute.mcap";
  const std::filesystem::path other = Sr1Run::instance().folder() / "other_minute.mcap";
};

/// Work: Trace::load() of both and compare(), which is a diff. Base: Trace::load() of both.
void diff_over_reading(benchmark::State& state, bool same) {
  static const TwoMinutes minutes;
  const std::filesystem::path& second = same ? minutes.golden : minutes.other;
  const std::vector<ToleranceRule>& rules = Sr1Run::instance().scenario().tolerances;
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    const auto diff = [&] {
      const Trace golden = must(Trace::load(minutes.golden)), actual = must(Trace::load(second));
      if (compare(golden, actual, rules).equal != same) state.SkipWithError("the traces are not what they should be");
    };
    const auto read = [&] {
      benchmark::DoNotOptimize(must(Trace::load(minutes.golden)));
      benchmark::DoNotOptimize(must(Trace::load(second)));
    };
    state.SetIterationTime(pairs.measure(diff, read));
  }
  pairs.report(state, 1.0, 1.0);
}

void diff_of_equal_traces_over_reading(benchmark::State& state) { diff_over_reading(state, true); }
BENCHMARK(diff_of_equal_traces_over_reading)->UseManualTime()->Unit(benchmark::kMillisecond);

void diff_of_unlike_traces_over_reading(benchmark::State& state) { diff_over_reading(state, false); }
BENCHMARK(diff_of_unlike_traces_over_reading)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
