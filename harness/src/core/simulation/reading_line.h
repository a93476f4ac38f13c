// ReadingLine: the way of a sensor's samples to the controllers: when samples are taken, which are lost, and when the
// others arrive.
#pragma once

#include <rehearse/sensor_errors.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rehearse {

class ReadingLine {
 public:
  /// `errors` must outlive this. `interval`: between samples without a rate [s]. `numbers`: of a sample.
  ReadingLine(const ReadingErrors& errors, std::uint64_t key, double time_step, double interval, std::size_t numbers);

  /// The index of the sample that is taken in this tick; nullopt: none is.
  std::optional<std::int64_t> sample_of(std::int64_t tick) const;
  double time_step() const { return time_step_; }  // [s]
  /// The time between samples [s].
  double interval() const { return interval_; }
  /// The numbers that arrive if the sample `values` is taken in this tick, if one is; else those that arrived last.
  /// Must be called once a tick, in order; again in the same tick it gives the same. True: they are new.
  bool pass(std::int64_t tick, std::optional<std::int64_t> sample, std::vector<double>& values);
  /// The tick at which the sample of this tick arrives.
  std::int64_t arrival_of(std::int64_t tick) const;
  /// Whether the reading of that sample, taken in this tick, is lost in a burst or by a fault.
  bool is_lost(std::int64_t tick, std::int64_t sample);
  /// Whether it repeats the sample before.
  bool is_stuck(std::int64_t tick) const;

  /// Visits all numbers that earlier samples determine. Their count depends on the errors alone.
  template <class Visit>
  void visit_state(Visit visit) {
    for (Arrival& arrival : waiting_) visit_arrival(arrival, visit);
    visit_arrival(last_, visit);
    visit_arrival(repeated_, visit);
    visit(before_);
    visit(now_);
  }

 private:
  /// A sample; ticks are whole numbers, held as the state holds them.
  struct Arrival {
    double taken = -1.0;  // tick; below 0: none
    double arrives = 0.0;
    std::vector<double> values;
  };

  template <class Visit>
  static void visit_arrival(Arrival& arrival, Visit visit) {
    visit(arrival.taken);
    visit(arrival.arrives);
    for (double& value : arrival.values) visit(value);
  }
  double time_of_tick(std::int64_t tick) const { return static_cast<double>(tick) * time_step_; }

  const ReadingErrors& errors_;
  const std::uint64_t key_;
  const double time_step_;
  const double interval_;
  // state
  std::vector<Arrival> waiting_;  // by the tick of the sample modulo its size
  Arrival last_;                  // the last that arrived
  Arrival repeated_;              // the last sample before readings are stuck
  double before_ = -1.0;          // tick of the sample that had arrived last before this tick
  double now_ = -1.0;             // this tick
  // the chain of bursts, which follows from the random numbers alone
  std::int64_t chain_ = -1;  // sample
  bool in_gap_ = false;
};

}  // namespace rehearse
