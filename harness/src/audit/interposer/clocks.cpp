// Functions that return the time.
#include "clocks.h"

#include <sys/resource.h>
#include <sys/time.h>
#include <sys/timeb.h>
#include <sys/times.h>
#include <unistd.h>

#include "next.h"

namespace rehearse::interposer {
namespace {

const char* name_of(clockid_t clock) {
  switch (clock) {
    case CLOCK_REALTIME: return "CLOCK_REALTIME";
    case CLOCK_MONOTONIC: return "CLOCK_MONOTONIC";
    case CLOCK_PROCESS_CPUTIME_ID: return "CLOCK_PROCESS_CPUTIME_ID";
    case CLOCK_THREAD_CPUTIME_ID: return "CLOCK_THREAD_CPUTIME_ID";
    case CLOCK_MONOTONIC_RAW: return "CLOCK_MONOTONIC_RAW";
    case CLOCK_REALTIME_COARSE: return "CLOCK_REALTIME_COARSE";
    case CLOCK_MONOTONIC_COARSE: return "CLOCK_MONOTONIC_COARSE";
    case CLOCK_BOOTTIME: return "CLOCK_BOOTTIME";
    case CLOCK_TAI: return "CLOCK_TAI";
    default: return "another clock";
  }
}

/// The lead decreases as the simulation advances: a clock never goes back.
ClockLead& lead_of(const Substitution& substitution) {
  ClockLead& lead = thread_state.lead[substitution.layer];
  const CurrentCall call = current_call();
  if (lead.call == call.number) return lead;
  const double run = call.time * 1e3 * static_cast<double>(substitution.rate);  // s * ppm -> ns
  const ClockLead before = lead;
  lead = {call.number, (static_cast<int64_t>(2.0 * run) + 1) / 2, 0};
  if (before.run + before.passed > lead.run) lead.passed = before.run + before.passed - lead.run;
  return lead;
}

}  // namespace

ClockKind kind_of(clockid_t clock) {
  switch (clock) {
    case CLOCK_REALTIME:
    case CLOCK_REALTIME_COARSE:
    case CLOCK_REALTIME_ALARM:
    case CLOCK_TAI: return ClockKind::date;
    case CLOCK_MONOTONIC:
    case CLOCK_MONOTONIC_RAW:
    case CLOCK_MONOTONIC_COARSE:
    case CLOCK_BOOTTIME:
    case CLOCK_BOOTTIME_ALARM: return ClockKind::monotonic;
    default: return ClockKind::processor_time;
  }
}

int64_t peek_clock(const Substitution& substitution, ClockKind kind) {
  const int64_t start = kind == ClockKind::date        ? substitution.date
                        : kind == ClockKind::monotonic ? substitution.uptime
                                                       : 0;
  const ClockLead& lead = lead_of(substitution);
  return start + lead.run + lead.passed;
}

int64_t read_clock(const Substitution& substitution, ClockKind kind) {
  const int64_t now = peek_clock(substitution, kind);
  for (int layer = 0; layer < 2; ++layer) {
    const Substitution& each = substitution_of_layer(layer);
    lead_of(each).passed += each.read_step;
  }
  return now;
}

void let_pass(int64_t nanoseconds) {
  if (nanoseconds <= 0) return;
  for (int layer = 0; layer < 2; ++layer) lead_of(substitution_of_layer(layer)).passed += nanoseconds;
}

REHEARSE_ANSWERED(has_clock, int, clock_gettime, (clockid_t clock, timespec* to), (clock, to), name_of(clock), {
  *to = timespec_of(read_clock(substitution, kind_of(clock)));
  return 0;
})

REHEARSE_ANSWERED(has_clock, int, timespec_get, (timespec * time, int base), (time, base), "", {
  if (base != TIME_UTC) return next_timespec_get.get()(time, base);
  *time = timespec_of(read_clock(substitution, ClockKind::date));
  return base;
})

REHEARSE_ANSWERED(has_clock, time_t, time, (time_t * also), (also), "", {
  const time_t seconds = timespec_of(read_clock(substitution, ClockKind::date)).tv_sec;
  if (also) *also = seconds;
  return seconds;
})

REHEARSE_ANSWERED(has_clock, int, gettimeofday, (timeval * time, void* zone), (time, zone), "", {
  if (!time) return next_gettimeofday.get()(time, zone);
  const timespec now = timespec_of(read_clock(substitution, ClockKind::date));
  *time = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
})

REHEARSE_ANSWERED(has_clock, int, ftime, (timeb * time), (time), "", {
  const timespec now = timespec_of(read_clock(substitution, ClockKind::date));
  *time = {now.tv_sec, static_cast<unsigned short>(now.tv_nsec / 1'000'000), 0, 0};
  return 0;
})

REHEARSE_ANSWERED(has_clock, clock_t, clock, (), (), "",
                  return read_clock(substitution, ClockKind::processor_time) / (1'000'000'000 / CLOCKS_PER_SEC);)

REHEARSE_ANSWERED(has_clock, clock_t, times, (tms * times), (times), "", {
  const int64_t tick = 1'000'000'000 / sysconf(_SC_CLK_TCK);
  if (times) *times = {read_clock(substitution, ClockKind::processor_time) / tick, 0, 0, 0};
  return read_clock(substitution, ClockKind::monotonic) / tick;
})

REHEARSE_ANSWERED(has_clock, int, getrusage, (int who, rusage* usage), (who, usage), "", {
  if (const int failed = next_getrusage.get()(who, usage)) return failed;
  const timespec now = timespec_of(read_clock(substitution, ClockKind::processor_time));
  const int64_t other = substitution.uptime / 1'000'000'000;  // with a different clock the counts differ, too
  *usage = {};
  usage->ru_utime = {now.tv_sec + other % 7, now.tv_nsec / 1000};
  usage->ru_stime = {other % 5, 0};
  usage->ru_maxrss = 20'000 + other;
  usage->ru_minflt = 3'000 + other;
  usage->ru_majflt = other % 11;
  usage->ru_nvcsw = 100 + other;
  usage->ru_nivcsw = 10 + other;
  return 0;
})

}  // namespace rehearse::interposer
