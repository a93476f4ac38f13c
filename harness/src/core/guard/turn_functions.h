// What the replacements of the C library's functions have in common by which threads take turns (turns/scheduler.h).
// Internal. To be included without _FORTIFY_SOURCE: see next_functions.h.
//
// turn_locks.cpp has the functions that wait for other threads, turn_clocks.cpp those of time, turn_descriptors.cpp
// those of descriptors, and turn_system_calls.cpp the same by system calls. Threads that take no turns get the
// functions of the C library.
#pragma once

#include <errno.h>
#include <limits.h>

#include <algorithm>
#include <cstdint>

#include "cost_counter.h"
#include "next_functions.h"
#include "turn_calls.h"

namespace rehearse {

inline TurnScheduler& turns() { return TurnScheduler::instance(); }

/// A deadline that doesn't come.
inline constexpr std::int64_t never = TurnThread::never;
inline constexpr std::int64_t second = 1'000'000'000;  // [ns]

inline std::int64_t nanoseconds_of(const timespec& time) {
  if (time.tv_sec >= never / second) return never;
  return time.tv_sec * second + time.tv_nsec;
}

inline std::int64_t nanoseconds_of(const timeval& time) {
  return nanoseconds_of(timespec{time.tv_sec, time.tv_usec * 1000});
}

inline bool is_date(clockid_t clock) {
  return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_REALTIME_ALARM ||
         clock == CLOCK_TAI;
}

/// False for clocks that measure the work of processors.
inline bool is_simulated(clockid_t clock) {
  return is_date(clock) || clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW ||
         clock == CLOCK_MONOTONIC_COARSE || clock == CLOCK_BOOTTIME || clock == CLOCK_BOOTTIME_ALARM;
}

inline std::int64_t epoch_of(clockid_t clock) {
  return is_date(clock) ? TurnScheduler::start_date : TurnScheduler::start_uptime;
}

/// A time of a clock, as one of the scheduler.
inline std::int64_t deadline_of(clockid_t clock, const timespec& time) {
  const std::int64_t at = nanoseconds_of(time);
  return at == never ? never : at - epoch_of(clock);
}

inline std::int64_t after(std::int64_t duration) {
  const std::int64_t now = turns().now();
  return duration >= never - now ? never : now + std::max<std::int64_t>(duration, 0);
}

/// Ends this thread, if it was cancelled. Called where the C library's function would do so.
inline void end_if_cancelled() {
  if (this_turn->is_cancelled) pthread_testcancel();
}

}  // namespace rehearse

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// Begins the definition of a function: it is the C library's for threads that take no turns.
#define REHEARSE_TURN(function, arguments) REHEARSE_TURN_IF(rehearse::waits_in_turns(), function, arguments)
/// A function with a deadline, or one that reads a clock: also for a thread that is alone.
#define REHEARSE_TIMED(function, arguments) REHEARSE_TURN_IF(rehearse::takes_turns(), function, arguments)
#define REHEARSE_TURN_IF(condition, function, arguments)      \
  if (!(condition)) return REHEARSE_NEXT(function) arguments; \
  rehearse::count_guarded(rehearse_counted_##function);       \
  const rehearse::HostCode own
// NOLINTEND(bugprone-macro-parentheses)
