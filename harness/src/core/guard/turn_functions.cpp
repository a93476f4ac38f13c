// The functions of the C library in which a thread waits, or wakes others, or reads a clock: of threads that take turns
// (turns/scheduler.h). All other threads get the functions of the C library.
//
// The objects stay those of the C library: a lock is taken by its function that doesn't wait. Only the waiting is the
// scheduler's. So an object may have been used before the first thread was started.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/turns/raw_call.h"
#include "core/turns/waited_descriptors.h"
#include "cost_counter.h"
#include "next_functions.h"
#include "turn_calls.h"

namespace {

using rehearse::HostCode;
using rehearse::next_functions;
using rehearse::raw_call;
using rehearse::takes_turns;
using rehearse::this_turn;
using rehearse::TurnScheduler;
using rehearse::TurnThread;
using rehearse::TurnWait;
using rehearse::waited_descriptors;
using rehearse::waits_in_turns;

constexpr std::int64_t never = TurnThread::never;
constexpr std::int64_t second = 1'000'000'000;  // [ns]

TurnScheduler& turns() { return TurnScheduler::instance(); }

std::int64_t nanoseconds_of(const timespec& time) {
  if (time.tv_sec >= never / second) return never;
  return time.tv_sec * second + time.tv_nsec;
}

std::int64_t nanoseconds_of(const timeval& time) { return nanoseconds_of(timespec{time.tv_sec, time.tv_usec * 1000}); }

bool is_valid(const timespec* time) {
  return time && time->tv_sec >= 0 && time->tv_nsec >= 0 && time->tv_nsec < second;
}

bool is_date(clockid_t clock) {
  return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_REALTIME_ALARM ||
         clock == CLOCK_TAI;
}

/// False for clocks that measure the work of processors.
bool is_simulated(clockid_t clock) {
  return is_date(clock) || clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW ||
         clock == CLOCK_MONOTONIC_COARSE || clock == CLOCK_BOOTTIME || clock == CLOCK_BOOTTIME_ALARM;
}

std::int64_t epoch_of(clockid_t clock) {
  return is_date(clock) ? TurnScheduler::start_date : TurnScheduler::start_uptime;
}

/// A time of a clock, as one of the scheduler.
std::int64_t deadline_of(clockid_t clock, const timespec& time) {
  const std::int64_t at = nanoseconds_of(time);
  return at == never ? never : at - epoch_of(clock);
}

std::int64_t after(std::int64_t duration) {
  const std::int64_t now = turns().now();
  return duration >= never - now ? never : now + std::max<std::int64_t>(duration, 0);
}

/// Dates increase with each read, because programs compare the stamps of two values.
std::int64_t read_clock(clockid_t clock) {
  static std::int64_t last_date = 0;
  const std::int64_t now = turns().read_time() + epoch_of(clock);
  if (!is_date(clock)) return now;
  const bool goes_on = last_date - now < second && last_date >= now;
  return last_date = goes_on ? last_date + 1 : now;
}

/// Ends this thread, if it was cancelled. Called where the C library's function would do so.
void end_if_cancelled() {
  if (this_turn->is_cancelled) pthread_testcancel();
}

int owner_of(const pthread_mutex_t* mutex) { return mutex->__data.__owner; }

/// Repeats `try_once`, which returns EBUSY while the object is taken.
template <class Try>
int lock(const TurnWait& wait, std::int64_t deadline, bool is_own, const Try& try_once) {
  if (is_own || !turns().is_promised(wait.object))
    if (const int result = try_once(); result != EBUSY) return result;
  for (;;) {
    if (deadline != never && deadline <= turns().now()) return ETIMEDOUT;
    turns().wait(wait, deadline);
    if (const int result = try_once(); result != EBUSY) return result;
  }
}

int lock_mutex(pthread_mutex_t* mutex, std::int64_t deadline = never) {
  const bool is_own = owner_of(mutex) == this_turn->tid;
  const int kind = mutex->__data.__kind & 3;
  if (is_own && kind == PTHREAD_MUTEX_ERRORCHECK) return EDEADLK;
  return lock({"a mutex", mutex, &mutex->__data.__owner, ~0u, true}, deadline, is_own,
              [&] { return pthread_mutex_trylock(mutex); });
}

int unlock_mutex(pthread_mutex_t* mutex) {
  const int result = next_functions().pthread_mutex_unlock_(mutex);
  if (mutex->__data.__lock == 0) turns().wake(mutex, 1);
  return result;
}

int wait_for(pthread_cond_t* condition, pthread_mutex_t* mutex, std::int64_t deadline) {
  if (const int failed = unlock_mutex(mutex)) return failed;
  const bool was_woken = turns().wait({"a condition", condition}, deadline);
  lock_mutex(mutex);
  end_if_cancelled();
  return was_woken ? 0 : ETIMEDOUT;
}

/// Its clock, by the bit in which the C library keeps it.
clockid_t clock_of(const pthread_cond_t* condition) {
  return (condition->__data.__wrefs & 2) != 0 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

int wait_for_semaphore(sem_t* semaphore, std::int64_t deadline) {
  for (;;) {
    if (sem_trywait(semaphore) == 0) return 0;
    if (errno != EAGAIN) return -1;
    if (deadline != never && deadline <= turns().now()) return errno = ETIMEDOUT, -1;
    turns().wait({"a semaphore", semaphore}, deadline);
    end_if_cancelled();
  }
}

int join(pthread_t handle, void** result, std::int64_t deadline = never) {
  TurnThread* const thread = turns().find(handle);
  if (thread == this_turn) return EDEADLK;
  if (!thread) return next_functions().pthread_join_(handle, result);
  while (thread->state != TurnThread::State::ended) {
    if (deadline != never && deadline <= turns().now()) return ETIMEDOUT;
    turns().wait({"the end of a thread", thread, nullptr, ~0u, true}, deadline);
    end_if_cancelled();
  }
  turns().erase(*thread);
  return next_functions().pthread_join_(handle, result);
}

/// The number of threads for which a barrier waits, and how many are there.
struct Barrier {
  unsigned count = 0, there = 0;
};

struct Barriers {
  std::mutex mutex;  // also threads without turns make barriers
  std::map<const void*, Barrier> all;
};

Barriers& barriers() {
  static auto& known = *new Barriers;
  return known;
}

std::vector<const void*>& running_once() {
  static auto& all = *new std::vector<const void*>;
  return all;
}

/// Runs `call`, unless another thread runs it for the same object.
template <class Call>
auto run_once(const void* control, const Call& call) {
  const auto runs = [&] { return std::ranges::find(running_once(), control) != running_once().end(); };
  while (runs()) turns().wait({"the first call of a function", control, nullptr, ~0u, true});
  struct Running {
    const void* control;
    explicit Running(const void* of) : control(of) { running_once().push_back(of); }
    ~Running() {
      std::erase(running_once(), control);
      turns().wake(control, INT_MAX);
    }
  } const running(control);
  return call();
}

/// True if only this process can make the descriptor ready.
bool is_of_process(int descriptor) {
  char link[64], name[64] = {};
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  if (raw_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(link), reinterpret_cast<long>(name), sizeof name - 1) <=
      0)
    return false;
  for (const char* kind : {"pipe:", "anon_inode:[eventfd]", "anon_inode:[timerfd]"})
    if (strncmp(name, kind, strlen(kind)) == 0) return true;
  return false;
}

bool is_ready(int descriptor, short events) {
  pollfd one{descriptor, events, 0};
  return next_functions().poll_(&one, 1, 0) != 0;
}

bool never_waits(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags < 0 || (flags & O_NONBLOCK) != 0;
}

/// Calls `look` until it isn't 0, at most until the deadline. `outside`: looks and waits, without a turn.
template <class Look, class Outside>
auto wait_for_descriptors(bool are_of_process, std::int64_t deadline, const Look& look, const Outside& outside) {
  for (;;) {
    const auto found = look();
    if (found != 0) return found;
    if (deadline <= turns().now()) {
      turns().read_time();
      return found;
    }
    if (this_turn->is_alone && deadline == never) return outside();
    if (!are_of_process) {
      turns().leave_for_outside("something outside of the process");
      const auto result = outside();
      const int number = errno;
      turns().come_back();
      errno = number;
      return result;
    }
    turns().wait({"a descriptor", waited_descriptors}, deadline);
    end_if_cancelled();
  }
}

/// Before a call that may wait for the descriptor. `call`: the call.
template <class Call>
auto call_when_ready(int descriptor, short events, const Call& call) {
  const bool may_wait = !is_ready(descriptor, events);
  if (may_wait && never_waits(descriptor)) {
    turns().read_time();
    return call();
  }
  if (may_wait) {
    using Outcome = decltype(call());
    constexpr Outcome not_called = -2;
    const Outcome result = wait_for_descriptors(
        is_of_process(descriptor), never, [&] { return is_ready(descriptor, events) ? not_called : Outcome{0}; }, call);
    if (result != not_called) return result;
  }
  return call();
}

int wait_for_polled(pollfd* files, nfds_t count, std::int64_t deadline, const sigset_t* mask) {
  const bool are_of_process =
      std::all_of(files, files + count, [](const pollfd& file) { return file.fd < 0 || is_of_process(file.fd); });
  const std::int64_t left = deadline == never ? never : deadline - turns().now();
  const timespec real{left / second, left % second};
  return wait_for_descriptors(
      are_of_process, deadline, [&] { return next_functions().poll_(files, count, 0); },
      [&] { return next_functions().ppoll_(files, count, deadline == never ? nullptr : &real, mask); });
}

int wait_for_selected(int count, fd_set* read, fd_set* write, fd_set* except, std::int64_t deadline,
                      const sigset_t* mask) {
  fd_set given[3];
  fd_set* const sets[] = {read, write, except};
  for (int i = 0; i < 3; ++i)
    if (sets[i]) given[i] = *sets[i];
  const auto restore = [&] {
    for (int i = 0; i < 3; ++i)
      if (sets[i]) *sets[i] = given[i];
  };
  bool are_of_process = true;
  for (int descriptor = 0; descriptor < count; ++descriptor)
    for (const fd_set* set : sets)
      if (set && FD_ISSET(descriptor, set)) are_of_process = are_of_process && is_of_process(descriptor);
  const std::int64_t left = deadline == never ? never : deadline - turns().now();
  const timespec real{left / second, left % second}, none{};
  const auto look = [&](const timespec* time) {
    restore();
    return next_functions().pselect_(count, read, write, except, time, mask);
  };
  return wait_for_descriptors(
      are_of_process, deadline, [&] { return look(&none); }, [&] { return look(deadline == never ? nullptr : &real); });
}

/// True if all descriptors that an epoll watches are of this process.
bool watches_process_only(int epoll) {
  char name[64];
  snprintf(name, sizeof name, "/proc/self/fdinfo/%d", epoll);
  const std::unique_ptr<FILE, int (*)(FILE*)> file(fopen(name, "re"), fclose);
  if (!file) return false;
  char line[256];
  int descriptor = -1;
  while (fgets(line, sizeof line, file.get()))
    if (sscanf(line, "tfd: %d", &descriptor) == 1 && !is_of_process(descriptor)) return false;
  return true;
}

/// The time of a call in milliseconds.
std::int64_t deadline_in(int milliseconds) {
  return milliseconds < 0 ? never : after(milliseconds * std::int64_t{1'000'000});
}

int result_of_thread_call(int error) {
  switch (error) {
    case 0: return thrd_success;
    case EBUSY: return thrd_busy;
    case ETIMEDOUT: return thrd_timedout;
    case ENOMEM: return thrd_nomem;
    default: return thrd_error;
  }
}

pthread_mutex_t* of(mtx_t* mutex) { return reinterpret_cast<pthread_mutex_t*>(mutex); }
pthread_cond_t* of(cnd_t* condition) { return reinterpret_cast<pthread_cond_t*>(condition); }

struct ThreadOfC {
  thrd_start_t routine;
  void* argument;
};

void* run_thread_of_c(void* given) {
  const std::unique_ptr<ThreadOfC> start(static_cast<ThreadOfC*>(given));
  return reinterpret_cast<void*>(static_cast<std::intptr_t>(start->routine(start->argument)));
}

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
    return turns().wake(word, most, bits);
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
      const long woken = wake(~0u);
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
__attribute__((visibility("default"))) bool rehearse_takes_turns() { return takes_turns(); }

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// Begins the definition of a function: it is the C library's for threads that take no turns.
#define REHEARSE_TURN(function, arguments) REHEARSE_TURN_IF(waits_in_turns(), function, arguments)
/// A function with a deadline, or one that reads a clock: also for a thread that is alone.
#define REHEARSE_TIMED(function, arguments) REHEARSE_TURN_IF(takes_turns(), function, arguments)
#define REHEARSE_TURN_IF(condition, function, arguments)      \
  if (!(condition)) return REHEARSE_NEXT(function) arguments; \
  rehearse::count_guarded(rehearse_counted_##function);       \
  const HostCode own

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  REHEARSE_TURN(pthread_mutex_lock, (mutex));
  return lock_mutex(mutex);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* deadline) noexcept {
  REHEARSE_TIMED(pthread_mutex_timedlock, (mutex, deadline));
  return lock_mutex(mutex, deadline_of(CLOCK_REALTIME, *deadline));
}

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const timespec* deadline) noexcept {
  REHEARSE_TIMED(pthread_mutex_clocklock, (mutex, clock, deadline));
  return lock_mutex(mutex, deadline_of(clock, *deadline));
}

int pthread_mutex_unlock(pthread_mutex_t* mutex) noexcept {
  REHEARSE_TURN(pthread_mutex_unlock, (mutex));
  return unlock_mutex(mutex);
}

#define REHEARSE_RWLOCK(function, tried, parameters, arguments, deadline)                                  \
  int function parameters noexcept {                                                                       \
    REHEARSE_TURN_IF(takes_turns() && (!this_turn->is_alone || (deadline) != never), function, arguments); \
    return lock({"a lock of readers and writers", rwlock, nullptr, ~0u, true}, deadline, false,            \
                [&] { return tried(rwlock); });                                                            \
  }
REHEARSE_RWLOCK(pthread_rwlock_rdlock, pthread_rwlock_tryrdlock, (pthread_rwlock_t * rwlock), (rwlock), never)
REHEARSE_RWLOCK(pthread_rwlock_wrlock, pthread_rwlock_trywrlock, (pthread_rwlock_t * rwlock), (rwlock), never)
REHEARSE_RWLOCK(pthread_rwlock_timedrdlock, pthread_rwlock_tryrdlock, (pthread_rwlock_t * rwlock, const timespec* time),
                (rwlock, time), deadline_of(CLOCK_REALTIME, *time))
REHEARSE_RWLOCK(pthread_rwlock_timedwrlock, pthread_rwlock_trywrlock, (pthread_rwlock_t * rwlock, const timespec* time),
                (rwlock, time), deadline_of(CLOCK_REALTIME, *time))
REHEARSE_RWLOCK(pthread_rwlock_clockrdlock, pthread_rwlock_tryrdlock,
                (pthread_rwlock_t * rwlock, clockid_t clock, const timespec* time), (rwlock, clock, time),
                deadline_of(clock, *time))
REHEARSE_RWLOCK(pthread_rwlock_clockwrlock, pthread_rwlock_trywrlock,
                (pthread_rwlock_t * rwlock, clockid_t clock, const timespec* time), (rwlock, clock, time),
                deadline_of(clock, *time))

int pthread_rwlock_unlock(pthread_rwlock_t* rwlock) noexcept {
  REHEARSE_TURN(pthread_rwlock_unlock, (rwlock));
  const int result = next_functions().pthread_rwlock_unlock_(rwlock);
  turns().wake(rwlock, INT_MAX);
  return result;
}

int pthread_spin_lock(pthread_spinlock_t* spin) noexcept {
  REHEARSE_TURN(pthread_spin_lock, (spin));
  const void* const object = const_cast<const int*>(spin);
  return lock({"a spin lock", object, nullptr, ~0u, true}, never, false, [&] { return pthread_spin_trylock(spin); });
}

int pthread_spin_unlock(pthread_spinlock_t* spin) noexcept {
  REHEARSE_TURN(pthread_spin_unlock, (spin));
  const int result = next_functions().pthread_spin_unlock_(spin);
  turns().wake(const_cast<const int*>(spin), 1);
  return result;
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  REHEARSE_TURN(pthread_cond_wait, (condition, mutex));
  return wait_for(condition, mutex, never);
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* deadline) {
  REHEARSE_TIMED(pthread_cond_timedwait, (condition, mutex, deadline));
  return wait_for(condition, mutex, deadline_of(clock_of(condition), *deadline));
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* deadline) {
  REHEARSE_TIMED(pthread_cond_clockwait, (condition, mutex, clock, deadline));
  return wait_for(condition, mutex, deadline_of(clock, *deadline));
}

int pthread_cond_signal(pthread_cond_t* condition) noexcept {
  REHEARSE_TURN(pthread_cond_signal, (condition));
  turns().wake(condition, 1);
  return 0;
}

int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
  REHEARSE_TURN(pthread_cond_broadcast, (condition));
  turns().wake(condition, INT_MAX);
  return 0;
}

int sem_wait(sem_t* semaphore) {
  REHEARSE_TURN(sem_wait, (semaphore));
  return wait_for_semaphore(semaphore, never);
}

int sem_timedwait(sem_t* semaphore, const timespec* deadline) {
  REHEARSE_TIMED(sem_timedwait, (semaphore, deadline));
  return wait_for_semaphore(semaphore, deadline_of(CLOCK_REALTIME, *deadline));
}

int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* deadline) {
  REHEARSE_TIMED(sem_clockwait, (semaphore, clock, deadline));
  return wait_for_semaphore(semaphore, deadline_of(clock, *deadline));
}

int sem_post(sem_t* semaphore) noexcept {
  REHEARSE_TURN(sem_post, (semaphore));
  const int result = next_functions().sem_post_(semaphore);
  turns().wake(semaphore, 1);
  return result;
}

int pthread_barrier_init(pthread_barrier_t* barrier, const pthread_barrierattr_t* attributes, unsigned count) noexcept {
  const int failed = REHEARSE_NEXT(pthread_barrier_init)(barrier, attributes, count);
  if (failed != 0 || !rehearse::in_controllers_code()) return failed;
  const HostCode own;
  const std::scoped_lock lock(barriers().mutex);
  barriers().all[barrier] = {count};
  return 0;
}

int pthread_barrier_wait(pthread_barrier_t* barrier) noexcept {
  REHEARSE_TURN(pthread_barrier_wait, (barrier));
  const auto found = barriers().all.find(barrier);
  if (found == barriers().all.end()) return next_functions().pthread_barrier_wait_(barrier);
  Barrier& here = found->second;
  if (++here.there < here.count) {
    turns().wait({"a barrier", barrier});
    return 0;
  }
  here.there = 0;
  turns().wake(barrier, INT_MAX);
  return PTHREAD_BARRIER_SERIAL_THREAD;
}

int pthread_once(pthread_once_t* control, void (*routine)()) {
  REHEARSE_TURN(pthread_once, (control, routine));
  return run_once(control, [&] { return next_functions().pthread_once_(control, routine); });
}

int pthread_join(pthread_t thread, void** result) {
  REHEARSE_TURN(pthread_join, (thread, result));
  return join(thread, result);
}

int pthread_tryjoin_np(pthread_t thread, void** result) noexcept {
  REHEARSE_TURN(pthread_tryjoin_np, (thread, result));
  const TurnThread* const known = turns().find(thread);
  if (known && known->state != TurnThread::State::ended) return turns().read_time(), EBUSY;
  return join(thread, result);
}

int pthread_timedjoin_np(pthread_t thread, void** result, const timespec* deadline) {
  REHEARSE_TIMED(pthread_timedjoin_np, (thread, result, deadline));
  return join(thread, result, deadline_of(CLOCK_REALTIME, *deadline));
}

int pthread_clockjoin_np(pthread_t thread, void** result, clockid_t clock, const timespec* deadline) {
  REHEARSE_TIMED(pthread_clockjoin_np, (thread, result, clock, deadline));
  return join(thread, result, deadline_of(clock, *deadline));
}

int pthread_detach(pthread_t thread) noexcept {
  REHEARSE_TURN(pthread_detach, (thread));
  if (TurnThread* const known = turns().find(thread)) turns().detach(*known);
  return next_functions().pthread_detach_(thread);
}

int pthread_cancel(pthread_t thread) {
  REHEARSE_TURN(pthread_cancel, (thread));
  const int result = next_functions().pthread_cancel_(thread);
  if (TurnThread* const known = turns().find(thread)) turns().interrupt(*known);
  return result;
}

int pthread_setname_np(pthread_t thread, const char* name) noexcept {
  rehearse::name_turn_thread(thread, name);
  return REHEARSE_NEXT(pthread_setname_np)(thread, name);
}

int prctl(int option, ...) noexcept {
  va_list more;
  va_start(more, option);
  unsigned long given[4];
  for (unsigned long& one : given) one = va_arg(more, unsigned long);
  va_end(more);
  if (option == PR_SET_NAME) rehearse::name_turn_thread(pthread_self(), reinterpret_cast<const char*>(given[0]));
  return REHEARSE_NEXT(prctl)(option, given[0], given[1], given[2], given[3]);
}

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

int poll(pollfd* files, nfds_t count, int milliseconds) {
  REHEARSE_TIMED(poll, (files, count, milliseconds));
  return wait_for_polled(files, count, deadline_in(milliseconds), nullptr);
}

int ppoll(pollfd* files, nfds_t count, const timespec* time, const sigset_t* mask) {
  REHEARSE_TIMED(ppoll, (files, count, time, mask));
  return wait_for_polled(files, count, time ? after(nanoseconds_of(*time)) : never, mask);
}

int select(int count, fd_set* read, fd_set* write, fd_set* except, timeval* time) {
  REHEARSE_TIMED(select, (count, read, write, except, time));
  return wait_for_selected(count, read, write, except, time ? after(nanoseconds_of(*time)) : never, nullptr);
}

int pselect(int count, fd_set* read, fd_set* write, fd_set* except, const timespec* time, const sigset_t* mask) {
  REHEARSE_TIMED(pselect, (count, read, write, except, time, mask));
  return wait_for_selected(count, read, write, except, time ? after(nanoseconds_of(*time)) : never, mask);
}

int epoll_wait(int epoll, epoll_event* events, int most, int milliseconds) {
  REHEARSE_TIMED(epoll_wait, (epoll, events, most, milliseconds));
  return wait_for_descriptors(
      watches_process_only(epoll), deadline_in(milliseconds),
      [&] { return next_functions().epoll_wait_(epoll, events, most, 0); },
      [&] { return next_functions().epoll_wait_(epoll, events, most, milliseconds); });
}

ssize_t read(int descriptor, void* bytes, size_t count) {
  REHEARSE_TURN(read, (descriptor, bytes, count));
  const ssize_t result =
      call_when_ready(descriptor, POLLIN, [&] { return next_functions().read_(descriptor, bytes, count); });
  if (result > 0) turns().wake(waited_descriptors, INT_MAX);  // a full pipe may have room now
  return result;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  REHEARSE_TURN(write, (descriptor, bytes, count));
  const ssize_t result =
      call_when_ready(descriptor, POLLOUT, [&] { return next_functions().write_(descriptor, bytes, count); });
  if (result > 0) turns().wake(waited_descriptors, INT_MAX);
  return result;
}

int eventfd_read(int descriptor, eventfd_t* value) {
  if (!takes_turns()) return REHEARSE_NEXT(eventfd_read)(descriptor, value);
  return read(descriptor, value, sizeof *value) == sizeof *value ? 0 : -1;
}

int eventfd_write(int descriptor, eventfd_t value) {
  if (!takes_turns()) return REHEARSE_NEXT(eventfd_write)(descriptor, value);
  return write(descriptor, &value, sizeof value) == sizeof value ? 0 : -1;
}

ssize_t recv(int socket, void* bytes, size_t count, int flags) {
  REHEARSE_TURN(recv, (socket, bytes, count, flags));
  const auto call = [&] { return next_functions().recv_(socket, bytes, count, flags); };
  return (flags & MSG_DONTWAIT) != 0 ? call() : call_when_ready(socket, POLLIN, call);
}

ssize_t recvfrom(int socket, void* bytes, size_t count, int flags, sockaddr* from, socklen_t* length) {
  REHEARSE_TURN(recvfrom, (socket, bytes, count, flags, from, length));
  const auto call = [&] { return next_functions().recvfrom_(socket, bytes, count, flags, from, length); };
  return (flags & MSG_DONTWAIT) != 0 ? call() : call_when_ready(socket, POLLIN, call);
}

ssize_t recvmsg(int socket, msghdr* message, int flags) {
  REHEARSE_TURN(recvmsg, (socket, message, flags));
  const auto call = [&] { return next_functions().recvmsg_(socket, message, flags); };
  return (flags & MSG_DONTWAIT) != 0 ? call() : call_when_ready(socket, POLLIN, call);
}

int accept(int socket, sockaddr* from, socklen_t* length) {
  REHEARSE_TURN(accept, (socket, from, length));
  return call_when_ready(socket, POLLIN, [&] { return next_functions().accept_(socket, from, length); });
}

/// A counter of events, to which the scheduler adds when the timer's time has come.
int timerfd_create(int clock, int flags) noexcept {
  REHEARSE_TIMED(timerfd_create, (clock, flags));
  const int descriptor = eventfd(0, flags);
  if (descriptor >= 0) turns().add_timer(descriptor, is_date(clock));
  return descriptor;
}

int timerfd_settime(int descriptor, int flags, const itimerspec* value, itimerspec* before) noexcept {
  if (!takes_turns() || !turns().timer(descriptor))
    return REHEARSE_NEXT(timerfd_settime)(descriptor, flags, value, before);
  const HostCode own;
  if (before) timerfd_gettime(descriptor, before);
  TurnScheduler::Timer& timer = *turns().timer(descriptor);
  const std::int64_t time = nanoseconds_of(value->it_value);
  timer.period = nanoseconds_of(value->it_interval);
  timer.next = time == 0                          ? never
               : (flags & TFD_TIMER_ABSTIME) != 0 ? time - epoch_of(timer.is_date ? CLOCK_REALTIME : CLOCK_MONOTONIC)
                                                  : after(time);
  std::uint64_t left = 0;
  if (is_ready(descriptor, POLLIN)) static_cast<void>(!next_functions().read_(descriptor, &left, sizeof left));
  return 0;
}

int timerfd_gettime(int descriptor, itimerspec* value) noexcept {
  if (!takes_turns() || !turns().timer(descriptor)) return REHEARSE_NEXT(timerfd_gettime)(descriptor, value);
  const HostCode own;
  const TurnScheduler::Timer& timer = *turns().timer(descriptor);
  const std::int64_t left = timer.next == never ? 0 : std::max<std::int64_t>(timer.next - turns().now(), 1);
  *value = {{timer.period / second, timer.period % second}, {left / second, left % second}};
  return 0;
}

// Threads of C11: the objects are those of the functions above.

int thrd_create(thrd_t* thread, thrd_start_t routine, void* argument) {
  if (!rehearse::in_controllers_code()) return REHEARSE_NEXT(thrd_create)(thread, routine, argument);
  const HostCode own;
  auto start = std::make_unique<ThreadOfC>(ThreadOfC{routine, argument});
  const int failed =
      rehearse::start_thread(thread, nullptr, run_thread_of_c, start.get(), reinterpret_cast<const void*>(routine));
  if (failed == 0) static_cast<void>(start.release());  // the thread owns it now
  return result_of_thread_call(failed == EAGAIN ? ENOMEM : failed);
}

int thrd_join(thrd_t thread, int* result) {
  if (!rehearse::in_controllers_code()) return REHEARSE_NEXT(thrd_join)(thread, result);
  void* value = nullptr;
  const int failed = pthread_join(thread, &value);
  if (result) *result = static_cast<int>(reinterpret_cast<std::intptr_t>(value));
  return result_of_thread_call(failed);
}

int thrd_detach(thrd_t thread) {
  REHEARSE_TURN(thrd_detach, (thread));
  return result_of_thread_call(pthread_detach(thread));
}

int thrd_sleep(const timespec* duration, timespec* left) {
  REHEARSE_TIMED(thrd_sleep, (duration, left));
  return nanosleep(duration, left) == 0 ? 0 : -2;
}

void thrd_yield() {
  REHEARSE_TURN(thrd_yield, ());
  turns().yield();
}

int mtx_lock(mtx_t* mutex) {
  REHEARSE_TURN(mtx_lock, (mutex));
  return result_of_thread_call(lock_mutex(of(mutex)));
}

int mtx_timedlock(mtx_t* mutex, const timespec* deadline) {
  REHEARSE_TIMED(mtx_timedlock, (mutex, deadline));
  return result_of_thread_call(lock_mutex(of(mutex), deadline_of(CLOCK_REALTIME, *deadline)));
}

int mtx_unlock(mtx_t* mutex) {
  REHEARSE_TURN(mtx_unlock, (mutex));
  return result_of_thread_call(unlock_mutex(of(mutex)));
}

int cnd_wait(cnd_t* condition, mtx_t* mutex) {
  REHEARSE_TURN(cnd_wait, (condition, mutex));
  return result_of_thread_call(wait_for(of(condition), of(mutex), never));
}

int cnd_timedwait(cnd_t* condition, mtx_t* mutex, const timespec* deadline) {
  REHEARSE_TIMED(cnd_timedwait, (condition, mutex, deadline));
  return result_of_thread_call(wait_for(of(condition), of(mutex), deadline_of(CLOCK_REALTIME, *deadline)));
}

int cnd_signal(cnd_t* condition) {
  REHEARSE_TURN(cnd_signal, (condition));
  turns().wake(of(condition), 1);
  return thrd_success;
}

int cnd_broadcast(cnd_t* condition) {
  REHEARSE_TURN(cnd_broadcast, (condition));
  turns().wake(of(condition), INT_MAX);
  return thrd_success;
}

void call_once(once_flag* flag, void (*routine)()) {
  REHEARSE_TURN(call_once, (flag, routine));
  run_once(flag, [&] {
    next_functions().call_once_(flag, routine);
    return 0;
  });
}
// NOLINTEND(bugprone-macro-parentheses)

}  // extern "C"
