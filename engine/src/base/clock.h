// Simulated time. It is computed from the tick number and never accumulated.
#pragma once

#include <cmath>
#include <cstdint>

namespace rehearse {

/// Time of a tick [s]: tick / (1 / time_step), the expression Choreonoid uses; tick * time_step differs in the last
/// bit.
inline double time_of(std::int64_t tick, double time_step) { return static_cast<double>(tick) / (1.0 / time_step); }

/// Time of a tick, rounded to whole nanoseconds: the log time of the tick's messages [ns].
inline std::uint64_t nanoseconds_of(std::int64_t tick, double time_step) {
  return static_cast<std::uint64_t>(std::llround(time_of(tick, time_step) * 1e9));
}

/// A log time, or the span between two of them [ns], in seconds [s].
inline double seconds_of(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

}  // namespace rehearse
