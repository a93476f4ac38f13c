// Signal: the judgements of a condition at the ticks of a run, computed in one pass. A condition that depends on later
// ticks is judged when they have come; a signal stores judgements for the length of its window, not of the run.
// Internal.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>

#include "expression.h"

namespace rehearse {

class Signal {
 public:
  Signal() = default;
  virtual ~Signal() = default;
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;

  /// The next tick [ns].
  virtual void take(ExpressionSource& source, std::int64_t tick, std::uint64_t time) = 0;
  /// No tick follows. `next`: the time at which one would be the next [ns].
  virtual void end(std::uint64_t next) = 0;
  /// The judgements that are known and weren't passed on, one for each tick, in the order of ticks.
  std::deque<Judged> ready;
};
using SignalPtr = std::unique_ptr<Signal>;

/// Times of ticks are rounded to nanoseconds, so a window is a nanosecond longer.
inline constexpr std::uint64_t window_slack = 1;  // [ns]

/// The condition itself. The expression must outlive the signal.
SignalPtr signal_of(const Expression& expression);
SignalPtr negation_of(SignalPtr of);
SignalPtr conjunction_of(SignalPtr a, SignalPtr b);
SignalPtr disjunction_of(SignalPtr a, SignalPtr b);
/// The truth without a margin.
SignalPtr guard_of(SignalPtr of);
/// Times of ticks, both ends included [ns].
struct TimeSpan {
  std::uint64_t from = 0;
  std::uint64_t until = std::numeric_limits<std::uint64_t>::max();

  bool has(std::uint64_t time) const { return from <= time && time <= until; }
};

/// True in a tick of the span in which the condition becomes true; also in its own first tick, if it is true there.
/// Without a margin. `happened` is set when it may have become true, and must outlive the signal.
SignalPtr rise_of(SignalPtr of, const TimeSpan& span, bool& happened);
/// True if the condition is true in all ticks from now on until a time has passed [ns].
SignalPtr lasting_of(SignalPtr of, std::uint64_t duration);
/// True if it is true in one of these ticks.
SignalPtr coming_of(SignalPtr of, std::uint64_t duration);
/// True if it was true in one of the ticks of the last `duration` [ns], this one included.
SignalPtr recent_of(SignalPtr of, std::uint64_t duration);
/// True from the first tick on in which it was true.
SignalPtr once_of(SignalPtr of);

}  // namespace rehearse
