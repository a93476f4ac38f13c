// System calls past the C library by which threads wait, of threads that take turns: libstdc++'s futures and atomics,
// Rust's standard library.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include <stdio.h>
#include <sys/syscall.h>

#include "core/turns/raw_call.h"
#include "turn_functions.h"

namespace {

using rehearse::after;
using rehearse::deadline_of;
using rehearse::nanoseconds_of;
using rehearse::never;
using rehearse::turns;

/// Returns -errno after a failure, as the kernel does.
long wait_on_futex(const std::uint32_t* word, std::uint32_t value, std::int64_t deadline, std::uint32_t mask) {
  if (__atomic_load_n(word, __ATOMIC_SEQ_CST) != value) return -EAGAIN;
  return turns().wait({"an atomic or a future", word, nullptr, mask}, deadline) ? 0 : -ETIMEDOUT;
}

long call_futex(const long (&given)[6]) {
  const auto* const word = reinterpret_cast<const std::uint32_t*>(given[0]);
  const auto operation = static_cast<int>(given[1]);
  const auto value = static_cast<std::uint32_t>(given[2]);
  const auto* const time = reinterpret_cast<const timespec*>(given[3]);
  const clockid_t clock = (operation & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
  const auto mask = static_cast<std::uint32_t>(given[5]);
  const auto wake = [&](std::uint32_t bits) -> long {
    const int most = given[2] > INT_MAX || given[2] < 0 ? INT_MAX : static_cast<int>(given[2]);
    const int woken = turns().wake(word, most, bits);
    turns().consider();
    return woken;
  };
  switch (operation & FUTEX_CMD_MASK) {
    case FUTEX_WAIT: return wait_on_futex(word, value, time ? after(nanoseconds_of(*time)) : never, ~0u);
    case FUTEX_WAIT_BITSET: return wait_on_futex(word, value, time ? deadline_of(clock, *time) : never, mask);
    case FUTEX_WAKE: return wake(~0u);
    case FUTEX_WAKE_BITSET: return wake(mask);
    case FUTEX_CMP_REQUEUE:
      if (__atomic_load_n(word, __ATOMIC_SEQ_CST) != mask) return -EAGAIN;
      [[fallthrough]];
    case FUTEX_REQUEUE: {
      const long woken = turns().wake(word, static_cast<int>(given[2]), ~0u);
      return woken + turns().requeue(word, reinterpret_cast<const void*>(given[4]), static_cast<int>(given[3]));
    }
    default: return -ENOSYS;
  }
}

template <class T>
T* to(long address) {
  return reinterpret_cast<T*>(address);
}

long kernels(long result) { return result == -1 ? -errno : result; }

}  // namespace

namespace rehearse {

bool answer_turn_call(long number, const long (&given)[6], long& result) {
  const HostCode own;
  const auto [a, b, c, d, e, f] = given;
  if (this_turn->is_alone && (number == SYS_futex ? d == 0 : number == SYS_read || number == SYS_write)) return false;
  switch (number) {
    case SYS_futex: result = call_futex(given); break;
    case SYS_sched_yield: result = kernels(sched_yield()); break;
    case SYS_nanosleep: result = kernels(nanosleep(to<timespec>(a), to<timespec>(b))); break;
    case SYS_clock_nanosleep:
      result = -clock_nanosleep(static_cast<clockid_t>(a), static_cast<int>(b), to<timespec>(c), to<timespec>(d));
      break;
    case SYS_clock_gettime: result = kernels(clock_gettime(static_cast<clockid_t>(a), to<timespec>(b))); break;
    case SYS_gettimeofday: result = kernels(gettimeofday(to<timeval>(a), to<void>(b))); break;
    case SYS_read: result = kernels(read(static_cast<int>(a), to<void>(b), static_cast<size_t>(c))); break;
    case SYS_write: result = kernels(write(static_cast<int>(a), to<void>(b), static_cast<size_t>(c))); break;
#ifdef SYS_poll
    case SYS_poll: result = kernels(poll(to<pollfd>(a), static_cast<nfds_t>(b), static_cast<int>(c))); break;
#endif
    default: return false;
  }
  if (result == -ENOSYS) return false;
  if (result < 0 && result >= -4095) {
    errno = static_cast<int>(-result);
    result = -1;
  }
  return true;
}

void note_turn_close(int descriptor) {
  if (takes_turns()) turns().remove_timer(descriptor);
}

void name_turn_thread(pthread_t handle, const char* name) {
  if (!takes_turns() || !name) return;
  TurnThread* const thread = pthread_equal(handle, pthread_self()) ? this_turn : turns().find(handle);
  if (thread && thread->number > 0) snprintf(thread->name, sizeof thread->name, "%s", name);
}

}  // namespace rehearse

extern "C" {

/// True if this thread takes turns: for the interposer.
__attribute__((visibility("default"))) bool rehearse_takes_turns() { return rehearse::takes_turns(); }

}  // extern "C"
