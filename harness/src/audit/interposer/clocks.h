// The simulated clocks.
#pragma once

#include <time.h>

#include "watching.h"

namespace rehearse::interposer {

enum class ClockKind { date, monotonic, processor_time };

ClockKind kind_of(clockid_t clock);

/// Reads a clock [ns]; each reading advances this thread's clocks by a step.
int64_t read_clock(const Substitution& substitution, ClockKind kind);

/// The time of a clock without a reading.
int64_t peek_clock(const Substitution& substitution, ClockKind kind);

/// Advances the clocks of this thread.
void let_pass(int64_t nanoseconds);

inline int64_t nanoseconds_of(const timespec& time) { return time.tv_sec * 1'000'000'000 + time.tv_nsec; }
inline timespec timespec_of(int64_t nanoseconds) {
  return {static_cast<time_t>(nanoseconds / 1'000'000'000), static_cast<long>(nanoseconds % 1'000'000'000)};
}

}  // namespace rehearse::interposer
