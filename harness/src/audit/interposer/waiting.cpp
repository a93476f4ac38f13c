// Functions that wait for a time. With a simulated clock, sleeping ends at once on the thread that calls the
// controller. The controller's own threads really sleep, because otherwise they would only spin.
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdlib.h>
#include <sys/select.h>
#include <sys/time.h>
#include <unistd.h>

#include "clocks.h"
#include "next.h"

namespace rehearse::interposer {
namespace {

/// Lets simulated time pass. True if the sleep is over.
bool slept(int64_t nanoseconds) {
  let_pass(nanoseconds);
  if (thread_state.own_thread) return false;
  sched_yield();  // the controller may wait for its own thread
  return true;
}

/// The real deadline for a deadline by a simulated clock [the same clock].
timespec real_deadline(const Substitution& substitution, clockid_t clock, const timespec& deadline) {
  const Busy busy;
  timespec now{};
  clock_gettime(clock, &now);
  const int64_t left = nanoseconds_of(deadline) - peek_clock(substitution, kind_of(clock));
  return timespec_of(nanoseconds_of(now) + (left > 0 ? left : 0));
}

/// After a timeout: advances the simulated clock to the deadline.
void reach(const Substitution& substitution, clockid_t clock, const timespec& deadline) {
  let_pass(nanoseconds_of(deadline) - peek_clock(substitution, kind_of(clock)));
}

/// pthread_cond_timedwait() and similar functions use CLOCK_REALTIME unless they were created otherwise, which can't be
/// queried. A deadline is near its own clock and years away from the other.
clockid_t clock_of(const Substitution& substitution, const timespec& deadline) {
  const int64_t to_date = nanoseconds_of(deadline) - peek_clock(substitution, ClockKind::date);
  const int64_t to_uptime = nanoseconds_of(deadline) - peek_clock(substitution, ClockKind::monotonic);
  return llabs(to_date) <= llabs(to_uptime) ? CLOCK_REALTIME : CLOCK_MONOTONIC;
}

}  // namespace

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// A function that sleeps for a number of nanoseconds if `sleeps`.
#define REHEARSE_SLEPT(result, name, parameters, arguments, sleeps, nanoseconds) \
  REHEARSE_ANSWERED(has_clock, result, name, parameters, arguments, "", {        \
    if ((sleeps) && slept(nanoseconds)) return 0;                                \
    return next_##name.get() arguments;                                          \
  })
REHEARSE_SLEPT(int, nanosleep, (const timespec* duration, timespec* left), (duration, left), true,
               nanoseconds_of(*duration))
REHEARSE_SLEPT(int, usleep, (useconds_t microseconds), (microseconds), true, microseconds * 1000LL)
REHEARSE_SLEPT(unsigned, sleep, (unsigned seconds), (seconds), true, seconds * 1'000'000'000LL)
REHEARSE_SLEPT(int, select, (int count, fd_set* read, fd_set* write, fd_set* except, timeval* timeout),
               (count, read, write, except, timeout), count == 0 && timeout,
               timeout->tv_sec * 1'000'000'000LL + timeout->tv_usec * 1000LL)
REHEARSE_SLEPT(int, poll, (pollfd * files, nfds_t count, int timeout), (files, count, timeout),
               count == 0 && timeout > 0, timeout * 1'000'000LL)
#undef REHEARSE_SLEPT

REHEARSE_ANSWERED(has_clock, int, clock_nanosleep, (clockid_t clock, int flags, const timespec* when, timespec* left),
                  (clock, flags, when, left), "", {
                    int64_t duration = nanoseconds_of(*when);
                    if (flags & TIMER_ABSTIME) duration -= peek_clock(substitution, kind_of(clock));
                    const timespec relative = timespec_of(duration > 0 ? duration : 0);
                    return slept(duration) ? 0 : next_clock_nanosleep.get()(clock, 0, &relative, left);
                  })

/// A function that waits until `deadline`, which is a time of `deadlines_clock`. The functions of semaphores return -1
/// and set errno, the others return the error number.
#define REHEARSE_WAITED(name, parameters, arguments, deadlines_clock)                              \
  REHEARSE_ANSWERED(has_clock, int, name, parameters, arguments, "", {                             \
    const clockid_t by_clock = deadlines_clock;                                                    \
    const timespec simulated = *deadline, real = real_deadline(substitution, by_clock, simulated); \
    deadline = &real;                                                                              \
    const int result = next_##name.get() arguments;                                                \
    const bool timed_out = result == ETIMEDOUT || (result == -1 && errno == ETIMEDOUT);            \
    if (timed_out) reach(substitution, by_clock, simulated);                                       \
    return result;                                                                                 \
  })
REHEARSE_WAITED(pthread_cond_timedwait, (pthread_cond_t * condition, pthread_mutex_t* mutex, const timespec* deadline),
                (condition, mutex, deadline), clock_of(substitution, *deadline))
REHEARSE_WAITED(pthread_cond_clockwait,
                (pthread_cond_t * condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* deadline),
                (condition, mutex, clock, deadline), clock)
REHEARSE_WAITED(pthread_mutex_timedlock, (pthread_mutex_t * mutex, const timespec* deadline), (mutex, deadline),
                CLOCK_REALTIME)
REHEARSE_WAITED(pthread_mutex_clocklock, (pthread_mutex_t * mutex, clockid_t clock, const timespec* deadline),
                (mutex, clock, deadline), clock)
REHEARSE_WAITED(sem_timedwait, (sem_t * semaphore, const timespec* deadline), (semaphore, deadline), CLOCK_REALTIME)
REHEARSE_WAITED(sem_clockwait, (sem_t * semaphore, clockid_t clock, const timespec* deadline),
                (semaphore, clock, deadline), clock)
#undef REHEARSE_WAITED
// NOLINTEND(bugprone-macro-parentheses)

REHEARSE_NOTED(int, timerfd_create, (int clock, int flags), (clock, flags), "")
REHEARSE_NOTED(int, timer_create, (clockid_t clock, void* event, void* timer), (clock, event, timer), "")
REHEARSE_NOTED(int, setitimer, (int which, const void* value, void* before), (which, value, before), "")
REHEARSE_NOTED(unsigned, alarm, (unsigned seconds), (seconds), Digits(seconds))

}  // namespace rehearse::interposer
