// CaptureCycle: the ticks at which a vision sensor captures, and at which its captures arrive. Private to the engine.
//
// A sensor that is on captures at tick 0 and then at the first tick at or after each multiple of its period. A capture
// arrives one period, but at most a second, after that multiple, at the first tick at or after it: at 30 Hz and 1 ms,
// captures of ticks 0, 34, 67 and 100 arrive at ticks 34, 67, 100 and 134 (Choreonoid's vision cycle, which always
// waits and carries over the delay of a capture). The cycle depends on the tick number alone.
#pragma once

#include "base/clock.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

namespace rehearse {

/// `Capture` is the result of one capture; a default-constructed one means no result.
template <class Capture>
class CaptureCycle {
 public:
  /// `rate` [Hz], `time_step` [s]
  CaptureCycle(double rate, double time_step)
      : period_(1.0 / std::max(0.1, rate)),  // Choreonoid's longest period is 10 s
        time_step_(time_step) {}

  /// Makes the capture that arrives at this tick current(). Returns true if current() has changed: a capture arrived or
  /// was removed.
  bool deliver(std::int64_t tick) {
    bool news = std::exchange(cleared_, false);
    if (!under_way_.empty() && under_way_.front().arrives <= tick) {
      current_ = std::move(under_way_.front());
      under_way_.pop_front();
      news = true;
    }
    return news;
  }
  const Capture& current() const { return current_.what; }
  double captured_at() const { return time_of(current_.captured, time_step_); }  // [s]

  /// True if the sensor captures at this tick. The caller then passes the result to capture().
  bool is_due(std::int64_t tick) const {
    return on_ && tick - first_tick_ >= tick_at_or_after(static_cast<double>(captures_) * period_);
  }
  /// Returns the tick at which the capture arrives.
  std::int64_t capture(std::int64_t tick, Capture what) {
    const double wanted = static_cast<double>(captures_) * period_;
    const std::int64_t arrives = first_tick_ + tick_at_or_after(wanted + std::min(period_, 1.0));
    under_way_.push_back({tick, std::max(tick + 1, arrives), std::move(what)});
    ++captures_;
    return under_way_.back().arrives;
  }

  /// Continues the cycle at this tick, as if the sensor had made all earlier captures of its series; earlier captures
  /// don't arrive. The sensor stays on or off.
  void begin_at(std::int64_t tick) {
    under_way_.clear();
    current_ = {};
    cleared_ = false;
    for (std::int64_t past = first_tick_; past < tick; ++past)
      if (is_due(past)) ++captures_;
  }

  /// Switches the sensor in this tick. Off: its captures are removed. On again: it captures at the next tick.
  void switch_to(bool on, std::int64_t tick) {
    if (on == on_) return;
    on_ = on;
    under_way_.clear();
    current_ = {};
    cleared_ = !on;
    first_tick_ = tick + 1;
    captures_ = 0;
  }

 private:
  struct Arrival {
    std::int64_t captured = 0;  // tick
    std::int64_t arrives = 0;   // tick
    Capture what{};
  };

  /// First tick at or after `time` [s]. `time` may contain a rounding error.
  std::int64_t tick_at_or_after(double time) const {
    return static_cast<std::int64_t>(std::ceil(time / time_step_ - 1e-9));
  }

  double period_;     // [s]
  double time_step_;  // [s]
  bool on_ = true;
  bool cleared_ = false;         // the sensor was switched off after the last deliver()
  std::int64_t first_tick_ = 0;  // of its current series of captures
  std::int64_t captures_ = 0;    // done in this series
  std::deque<Arrival> under_way_;
  Arrival current_;
};

}  // namespace rehearse
