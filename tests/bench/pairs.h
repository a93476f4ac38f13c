// Measures two pieces of work in turns, so that other load on the machine slows both: only their ratio counts.
#pragma once

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rehearse {

class Pairs {
 public:
  /// `busy`: the processor-time clock that is measured in addition to wall time.
  explicit Pairs(clockid_t busy = CLOCK_THREAD_CPUTIME_ID) : Pairs(busy, busy) {}
  /// Work and base run in separate processes.
  Pairs(clockid_t work_busy, clockid_t base_busy) : work_busy_(work_busy), base_busy_(base_busy) {}

  /// Measures both once; the one that was second last time is first. Returns the wall time of `work` [s].
  template <class Work, class Base>
  double measure(Work&& work, Base&& base) {
    const bool base_first = works_.size() % 2 == 0;
    if (base_first) bases_.push_back(timed(base, base_busy_));
    works_.push_back(timed(work, work_busy_));
    if (!base_first) bases_.push_back(timed(base, base_busy_));
    return works_.back().wall;
  }

  /// The medians of the pairs' ratios and of both sides [µs], per unit: a tick, a frame. Once of wall time, to which
  /// the budgets refer, and once of the calling thread's processor time, which is more reliable on a machine with other
  /// load. Nothing if no pair was measured.
  void report(benchmark::State& state, double work_units, double base_units) const {
    if (works_.empty()) return;  // the benchmark was skipped with an error
    const auto put = [&](const std::string& suffix, double Times::*clock) {
      std::vector<double> ratios, works, bases;
      for (std::size_t i = 0; i < works_.size(); ++i) {
        works.push_back(works_[i].*clock / work_units);
        bases.push_back(bases_[i].*clock / base_units);
        ratios.push_back(works.back() / bases.back());
      }
      state.counters["ratio" + suffix] = median(ratios);
      state.counters["work_us" + suffix] = 1e6 * median(works);
      state.counters["base_us" + suffix] = 1e6 * median(bases);
    };
    put("", &Times::wall);
    put("_busy", &Times::busy);
  }

 private:
  struct Times {
    double wall = 0.0;  // [s]
    double busy = 0.0;  // [s]
  };

  static double now(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  template <class Work>
  static Times timed(Work&& work, clockid_t busy) {
    const Times begin{now(CLOCK_MONOTONIC), now(busy)};
    work();
    return {now(CLOCK_MONOTONIC) - begin.wall, now(busy) - begin.busy};
  }

  static double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  clockid_t work_busy_, base_busy_;
  std::vector<Times> works_, bases_;
};

}  // namespace rehearse
