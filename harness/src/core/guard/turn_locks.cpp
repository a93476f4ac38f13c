// Functions by which a thread waits for others, or wakes them, of threads that take turns: locks, conditions,
// semaphores, barriers, the ends of threads, and their forms of C11.
//
// The objects stay those of the C library: a lock is taken by its function that doesn't wait. Only the waiting is the
// scheduler's. So an object may have been used before the first thread was started.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include <stdarg.h>
#include <stdio.h>
#include <sys/prctl.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "turn_functions.h"

namespace {

using rehearse::deadline_of;
using rehearse::end_if_cancelled;
using rehearse::HostCode;
using rehearse::never;
using rehearse::next_functions;
using rehearse::takes_turns;
using rehearse::this_turn;
using rehearse::turns;
using rehearse::TurnThread;
using rehearse::TurnWait;

int owner_of(const pthread_mutex_t* mutex) { return mutex->__data.__owner; }

/// Repeats `try_once`, which returns EBUSY while the object is taken.
template <class Try>
int lock(const TurnWait& wait, std::int64_t deadline, bool is_own, const Try& try_once) {
  if (!is_own) turns().consider();
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

/// Wakes up to `count` threads that wait for the object; one of them may come first.
void wake(const void* object, int count) {
  turns().wake(object, count);
  turns().consider();
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

}  // namespace

extern "C" {

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
  const int result = unlock_mutex(mutex);
  turns().consider();
  return result;
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
  wake(rwlock, INT_MAX);
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
  wake(const_cast<const int*>(spin), 1);
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
  wake(condition, 1);
  return 0;
}

int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
  REHEARSE_TURN(pthread_cond_broadcast, (condition));
  wake(condition, INT_MAX);
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
  wake(semaphore, 1);
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
  wake(barrier, INT_MAX);
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
  const int result = unlock_mutex(of(mutex));
  turns().consider();
  return result_of_thread_call(result);
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
  wake(of(condition), 1);
  return thrd_success;
}

int cnd_broadcast(cnd_t* condition) {
  REHEARSE_TURN(cnd_broadcast, (condition));
  wake(of(condition), INT_MAX);
  return thrd_success;
}

void call_once(once_flag* flag, void (*routine)()) {
  REHEARSE_TURN(call_once, (flag, routine));
  run_once(flag, [&] {
    next_functions().call_once_(flag, routine);
    return 0;
  });
}

}  // extern "C"
