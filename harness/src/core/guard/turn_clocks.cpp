// Functions that read a clock, sleep or yield, of threads that take turns.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include "turn_functions.h"

namespace {

using rehearse::after;
using rehearse::deadline_of;
using rehearse::end_if_cancelled;
using rehearse::epoch_of;
using rehearse::HostCode;
using rehearse::is_date;
using rehearse::is_simulated;
using rehearse::nanoseconds_of;
using rehearse::second;
using rehearse::takes_turns;
using rehearse::turns;

bool is_valid(const timespec* time) {
  return time && time->tv_sec >= 0 && time->tv_nsec >= 0 && time->tv_nsec < second;
}

/// Dates increase with each read, because programs compare the stamps of two values.
std::int64_t read_clock(clockid_t clock) {
  static std::int64_t last_date = 0;
  const std::int64_t now = turns().read_time() + epoch_of(clock);
  if (!is_date(clock)) return now;
  const bool goes_on = last_date - now < second && last_date >= now;
  return last_date = goes_on ? last_date + 1 : now;
}

}  // namespace

extern "C" {

int sched_yield() noexcept {
  REHEARSE_TURN(sched_yield, ());
  turns().yield();
  return 0;
}

int nanosleep(const timespec* duration, timespec* left) {
  REHEARSE_TIMED(nanosleep, (duration, left));
  if (!is_valid(duration)) return errno = EINVAL, -1;
  turns().sleep_until(after(nanoseconds_of(*duration)));
  end_if_cancelled();
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (!is_simulated(clock)) return REHEARSE_NEXT(clock_nanosleep)(clock, flags, time, left);
  REHEARSE_TIMED(clock_nanosleep, (clock, flags, time, left));
  if (!is_valid(time)) return EINVAL;
  turns().sleep_until((flags & TIMER_ABSTIME) != 0 ? deadline_of(clock, *time) : after(nanoseconds_of(*time)));
  end_if_cancelled();
  return 0;
}

int usleep(useconds_t microseconds) {
  REHEARSE_TIMED(usleep, (microseconds));
  turns().sleep_until(after(microseconds * std::int64_t{1000}));
  end_if_cancelled();
  return 0;
}

unsigned sleep(unsigned seconds) {
  REHEARSE_TIMED(sleep, (seconds));
  turns().sleep_until(after(seconds * second));
  end_if_cancelled();
  return 0;
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (!takes_turns() || !is_simulated(clock)) return REHEARSE_NEXT(clock_gettime)(clock, time);
  const HostCode own;
  const std::int64_t now = read_clock(clock);
  *time = {now / second, now % second};
  return 0;
}

int gettimeofday(timeval* time, void* zone) noexcept {
  if (!takes_turns()) return REHEARSE_NEXT(gettimeofday)(time, zone);
  const HostCode own;
  const std::int64_t now = read_clock(CLOCK_REALTIME);
  *time = {now / second, now % second / 1000};
  return 0;
}

time_t time(time_t* also) noexcept {
  REHEARSE_TIMED(time, (also));
  const time_t seconds = read_clock(CLOCK_REALTIME) / second;
  if (also) *also = seconds;
  return seconds;
}

int timespec_get(timespec* time, int base) noexcept {
  if (!takes_turns() || base != TIME_UTC) return REHEARSE_NEXT(timespec_get)(time, base);
  const HostCode own;
  const std::int64_t now = read_clock(CLOCK_REALTIME);
  *time = {now / second, now % second};
  return base;
}

int thrd_sleep(const timespec* duration, timespec* left) {
  REHEARSE_TIMED(thrd_sleep, (duration, left));
  return nanosleep(duration, left) == 0 ? 0 : -2;
}

void thrd_yield() {
  REHEARSE_TURN(thrd_yield, ());
  turns().yield();
}

}  // extern "C"
