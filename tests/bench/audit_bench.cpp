// The cost of an audit with all its replays, of one that counts instructions, and of one that finds executed lines,
// relative to one replay.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

/// Wall time, and what a program and all the processes that it starts take of the processors.
struct Cost {
  double wall = 0.0, busy = 0.0;  // [s]
};

double busy_children() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Cost cost_of(benchmark::State& state, const std::string& arguments) {
  using Clock = std::chrono::steady_clock;
  const double busy = busy_children();
  const Clock::time_point begin = Clock::now();
  if (std::system((REHEARSE_COMMAND " " + arguments + " > /dev/null").c_str()) != 0)
    state.SkipWithError(("rehearse " + arguments + " failed").c_str());
  return {std::chrono::duration<double>(Clock::now() - begin).count(), busy_children() - busy};
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Work: `rehearse audit` of a recording, without what it takes to start (an audit of two ticks). Base: `rehearse
/// replay` of it. The processes of an audit run two at a time; `busy` is all that they compute.
void over_one_replay(benchmark::State& state, const std::string& verb) {
  const Sr1Run& sr1 = Sr1Run::instance();
  const std::string trace = "'" + sr1.trace().string() + "'";
  const auto ticks = static_cast<double>(sr1.ticks());
  std::vector<double> ratios, busy_ratios, works, bases;
  for (auto _ : Repeated(state)) {
    const Cost audit = cost_of(state, verb + trace), start = cost_of(state, verb + "--until 0.002 " + trace);
    const Cost replay = cost_of(state, "replay " + trace);
    state.SetIterationTime(audit.wall);
    works.push_back(1e6 * (audit.wall - start.wall) / ticks);
    bases.push_back(1e6 * replay.wall / ticks);
    ratios.push_back(works.back() / bases.back());
    busy_ratios.push_back((audit.busy - start.busy) / replay.busy);
  }
  state.counters["ratio"] = median(ratios);
  state.counters["ratio_busy"] = median(busy_ratios);
  state.counters["work_us"] = median(works);
  state.counters["base_us"] = median(bases);
}

void audit_over_one_replay(benchmark::State& state) { over_one_replay(state, "audit "); }
BENCHMARK(audit_over_one_replay)->UseManualTime()->Unit(benchmark::kMillisecond);

void instructions_over_one_replay(benchmark::State& state) { over_one_replay(state, "audit --instructions "); }
BENCHMARK(instructions_over_one_replay)->UseManualTime()->Unit(benchmark::kMillisecond);

void coverage_over_one_replay(benchmark::State& state) { over_one_replay(state, "audit --coverage "); }
BENCHMARK(coverage_over_one_replay)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
