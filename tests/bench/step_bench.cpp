// The cost of inspecting ticks of a long recording: a step back, a jump, opening it.

#include <rehearse/session.h>
#include <rehearse/trace.h>

#include "base/clock.h"
#include "pairs.h"
#include "sr1_run.h"
#include "viewing/stepping/tick_view.h"

namespace rehearse {
namespace {

constexpr double minute = 60.0;  // [s]

/// A minute of SR1, opened once; its controllers replayed.
class Minute {
 public:
  Minute() {
    Scenario scenario = Sr1Run::instance().scenario();
    scenario.duration = minute;
    must(record(scenario, file));
    trace = must(SteppedTrace::open(file));
    if (trace->differs() || trace->last_replayed() != trace->last_tick()) std::abort();
  }
  static Minute& instance() {
    static Minute minute_of_sr1;
    return minute_of_sr1;
  }
  const std::filesystem::path file = Sr1Run::instance().folder() / "stepped_minute.mcap";
  std::unique_ptr<SteppedTrace> trace;
};

/// A tick further back each time, with all that is shown of it: at most 100 ms.
void step_back_by_one_tick(benchmark::State& state) {
  SteppedTrace& trace = *Minute::instance().trace;
  std::int64_t tick = trace.last_tick();
  for (auto _ : state) {
    benchmark::DoNotOptimize(trace.view(tick).channels.size());
    tick = tick > trace.first_tick() ? tick - 1 : trace.last_tick();
  }
}
BENCHMARK(step_back_by_one_tick)->MinTime(1)->Unit(benchmark::kMillisecond);

/// Places far from each other, so that none is in memory: at most 500 ms.
void go_to_any_tick(benchmark::State& state) {
  SteppedTrace& trace = *Minute::instance().trace;
  const std::int64_t ticks = trace.last_tick() + 1;
  std::int64_t tick = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(trace.view(tick).channels.size());
    tick = (tick + 22'801) % ticks;  // has no divisor in common with the number of ticks
  }
}
BENCHMARK(go_to_any_tick)->MinTime(1)->Unit(benchmark::kMillisecond);

/// Work: a SteppedTrace of a minute, replayed. Base: Trace::load() of it.
void open_over_reading(benchmark::State& state) {
  const std::filesystem::path& file = Minute::instance().file;
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { benchmark::DoNotOptimize(must(SteppedTrace::open(file)).get()); },
                                         [&] { benchmark::DoNotOptimize(must(Trace::load(file)).ticks()); }));
  pairs.report(state, 1.0, 1.0);
}
BENCHMARK(open_over_reading)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: a question to all ticks of a minute. Base: Trace::load() of it.
void search_over_reading(benchmark::State& state) {
  SteppedTrace& trace = *Minute::instance().trace;
  const Expression expression =
      must(Expression::parse("abs(delta(output/RLEG_KNEE/u)) > 1e9 && contact(RLEG_ANKLE_R)", trace));
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure(
        [&] {
          if (find_tick(expression, trace, trace.first_tick(), Direction::forwards))
            state.SkipWithError("it never holds");
        },
        [&] { benchmark::DoNotOptimize(must(Trace::load(Minute::instance().file)).ticks()); }));
  pairs.report(state, 1.0, 1.0);
}
BENCHMARK(search_over_reading)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
