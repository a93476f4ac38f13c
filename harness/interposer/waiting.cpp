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

/// True if the sleep is over: simulated time has passed.
bool slept(const Caller& caller, int64_t nanoseconds) {
  if (!substitution_for(caller).has_clock) return false;
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

/// `wait` gets the real deadline, and returns 0 or an error number.
template <class Wait>
int wait_until(const Caller& caller, clockid_t clock, const timespec& deadline, Wait wait) {
  const Substitution& substitution = substitution_for(caller);
  if (!substitution.has_clock) return wait(deadline);
  const int result = wait(real_deadline(substitution, clock, deadline));
  if (result == ETIMEDOUT) reach(substitution, clock, deadline);
  return result;
}

}  // namespace

REHEARSE_INTERPOSED(int, nanosleep, (const timespec* duration, timespec* left)) {
  if (!watching()) return next_nanosleep.get()(duration, left);
  const Caller caller = note(Source::clock, "nanosleep", "", __builtin_return_address(0));
  return slept(caller, nanoseconds_of(*duration)) ? 0 : next_nanosleep.get()(duration, left);
}

REHEARSE_INTERPOSED(int, clock_nanosleep, (clockid_t clock, int flags, const timespec* when, timespec* left)) {
  if (!watching()) return next_clock_nanosleep.get()(clock, flags, when, left);
  const Caller caller = note(Source::clock, "clock_nanosleep", "", __builtin_return_address(0));
  const Substitution& substitution = substitution_for(caller);
  if (!substitution.has_clock) return next_clock_nanosleep.get()(clock, flags, when, left);
  int64_t duration = nanoseconds_of(*when);
  if (flags & TIMER_ABSTIME) duration -= peek_clock(substitution, kind_of(clock));
  const timespec relative = timespec_of(duration > 0 ? duration : 0);
  return slept(caller, duration) ? 0 : next_clock_nanosleep.get()(clock, 0, &relative, left);
}

REHEARSE_INTERPOSED(int, usleep, (useconds_t microseconds)) {
  if (!watching()) return next_usleep.get()(microseconds);
  const Caller caller = note(Source::clock, "usleep", "", __builtin_return_address(0));
  return slept(caller, microseconds * 1000LL) ? 0 : next_usleep.get()(microseconds);
}

REHEARSE_INTERPOSED(unsigned, sleep, (unsigned seconds)) {
  if (!watching()) return next_sleep.get()(seconds);
  const Caller caller = note(Source::clock, "sleep", "", __builtin_return_address(0));
  return slept(caller, seconds * 1'000'000'000LL) ? 0 : next_sleep.get()(seconds);
}

REHEARSE_INTERPOSED(int, pthread_cond_timedwait,
                    (pthread_cond_t * condition, pthread_mutex_t* mutex, const timespec* deadline)) {
  if (!watching()) return next_pthread_cond_timedwait.get()(condition, mutex, deadline);
  const Caller caller = note(Source::clock, "pthread_cond_timedwait", "", __builtin_return_address(0));
  return wait_until(caller, clock_of(substitution_for(caller), *deadline), *deadline,
                    [&](const timespec& until) { return next_pthread_cond_timedwait.get()(condition, mutex, &until); });
}

REHEARSE_INTERPOSED(int, pthread_cond_clockwait,
                    (pthread_cond_t * condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* deadline)) {
  if (!watching()) return next_pthread_cond_clockwait.get()(condition, mutex, clock, deadline);
  const Caller caller = note(Source::clock, "pthread_cond_clockwait", "", __builtin_return_address(0));
  return wait_until(caller, clock, *deadline, [&](const timespec& until) {
    return next_pthread_cond_clockwait.get()(condition, mutex, clock, &until);
  });
}

REHEARSE_INTERPOSED(int, pthread_mutex_timedlock, (pthread_mutex_t * mutex, const timespec* deadline)) {
  if (!watching()) return next_pthread_mutex_timedlock.get()(mutex, deadline);
  const Caller caller = note(Source::clock, "pthread_mutex_timedlock", "", __builtin_return_address(0));
  return wait_until(caller, CLOCK_REALTIME, *deadline,
                    [&](const timespec& until) { return next_pthread_mutex_timedlock.get()(mutex, &until); });
}

REHEARSE_INTERPOSED(int, pthread_mutex_clocklock,
                    (pthread_mutex_t * mutex, clockid_t clock, const timespec* deadline)) {
  if (!watching()) return next_pthread_mutex_clocklock.get()(mutex, clock, deadline);
  const Caller caller = note(Source::clock, "pthread_mutex_clocklock", "", __builtin_return_address(0));
  return wait_until(caller, clock, *deadline,
                    [&](const timespec& until) { return next_pthread_mutex_clocklock.get()(mutex, clock, &until); });
}

REHEARSE_INTERPOSED(int, sem_timedwait, (sem_t * semaphore, const timespec* deadline)) {
  if (!watching()) return next_sem_timedwait.get()(semaphore, deadline);
  const Caller caller = note(Source::clock, "sem_timedwait", "", __builtin_return_address(0));
  const int result = wait_until(caller, CLOCK_REALTIME, *deadline, [&](const timespec& until) {
    return next_sem_timedwait.get()(semaphore, &until) == 0 ? 0 : errno;
  });
  if (result == 0) return 0;
  errno = result;
  return -1;
}

REHEARSE_INTERPOSED(int, sem_clockwait, (sem_t * semaphore, clockid_t clock, const timespec* deadline)) {
  if (!watching()) return next_sem_clockwait.get()(semaphore, clock, deadline);
  const Caller caller = note(Source::clock, "sem_clockwait", "", __builtin_return_address(0));
  const int result = wait_until(caller, clock, *deadline, [&](const timespec& until) {
    return next_sem_clockwait.get()(semaphore, clock, &until) == 0 ? 0 : errno;
  });
  if (result == 0) return 0;
  errno = result;
  return -1;
}

REHEARSE_INTERPOSED(int, select, (int count, fd_set* read, fd_set* write, fd_set* except, timeval* timeout)) {
  if (!watching()) return next_select.get()(count, read, write, except, timeout);
  const Caller caller = note(Source::clock, "select", "", __builtin_return_address(0));
  if (count == 0 && timeout && slept(caller, timeout->tv_sec * 1'000'000'000LL + timeout->tv_usec * 1000LL)) return 0;
  return next_select.get()(count, read, write, except, timeout);
}

REHEARSE_INTERPOSED(int, poll, (pollfd * files, nfds_t count, int timeout)) {
  if (!watching()) return next_poll.get()(files, count, timeout);
  const Caller caller = note(Source::clock, "poll", "", __builtin_return_address(0));
  if (count == 0 && timeout > 0 && slept(caller, timeout * 1'000'000LL)) return 0;
  return next_poll.get()(files, count, timeout);
}

REHEARSE_NOTED(clock, int, timerfd_create, (int clock, int flags), (clock, flags), "")
REHEARSE_NOTED(clock, int, timer_create, (clockid_t clock, void* event, void* timer), (clock, event, timer), "")
REHEARSE_NOTED(clock, int, setitimer, (int which, const void* value, void* before), (which, value, before), "")
REHEARSE_NOTED(clock, unsigned, alarm, (unsigned seconds), (seconds), Digits(seconds))

}  // namespace rehearse::interposer
