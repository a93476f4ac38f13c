// Measures two pieces of work in turns, so that other load on the machine slows both: only their ratio counts.
#pragma once

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

namespace rehearse {

/// The range of a benchmark's loop, as the library's `state`, whose iterations each repeat it until
/// $REHEARSE_BENCH_SECONDS of the clock have passed since the program began: what comes before the loop counts, too. It
/// is repeated at least `fewest` times. Without that variable it is repeated once, and the library decides on
/// iterations.
class Repeated {
  using Clock = std::chrono::steady_clock;
  static inline const Clock::time_point program_began = Clock::now();
  static constexpr int fewest = 3;

 public:
  explicit Repeated(benchmark::State& state) : state_(state) {
    if (const char* seconds = std::getenv("REHEARSE_BENCH_SECONDS"))
      end_ = program_began +
             std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::atof(seconds)));
  }

  class Iterator {
   public:
    Iterator(const Repeated* range, benchmark::State::StateIterator iteration) : range_(range), iteration_(iteration) {}
    bool operator!=(const Iterator& end) const { return iteration_ != end.iteration_; }
    auto operator*() const { return *iteration_; }
    Iterator& operator++() {
      ++count_;
      // a repetition that won't end in time isn't begun
      const Clock::time_point now = Clock::now();
      const bool again = count_ < fewest || now + (now - began_) / count_ < range_->end_;
      if (range_->end_ == Clock::time_point{} || range_->state_.error_occurred() || !again) ++iteration_;
      return *this;
    }

   private:
    const Repeated* range_;
    benchmark::State::StateIterator iteration_;
    Clock::time_point began_ = Clock::now();
    int count_ = 0;
  };

  Iterator begin() { return {this, state_.begin()}; }
  Iterator end() { return {this, state_.end()}; }

 private:
  benchmark::State& state_;
  Clock::time_point end_{};  // of the repetitions
};

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
