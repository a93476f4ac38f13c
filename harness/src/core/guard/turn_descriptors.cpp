// Functions that wait for a descriptor, and timers in descriptors, of threads that take turns.
//
// If only this process can make the descriptors ready, as those of pipes, events and timers, another thread does so in
// its turn. Else the thread waits in the kernel, and the others go on meanwhile.
#undef _FORTIFY_SOURCE  // see next_functions.h
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>

#include <memory>

#include "core/turns/raw_call.h"
#include "core/turns/waited_descriptors.h"
#include "turn_functions.h"

namespace {

using rehearse::after;
using rehearse::end_if_cancelled;
using rehearse::epoch_of;
using rehearse::HostCode;
using rehearse::is_date;
using rehearse::nanoseconds_of;
using rehearse::never;
using rehearse::next_functions;
using rehearse::raw_call;
using rehearse::second;
using rehearse::takes_turns;
using rehearse::this_turn;
using rehearse::turns;
using rehearse::TurnScheduler;
using rehearse::waited_descriptors;

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

}  // namespace

extern "C" {

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

}  // extern "C"
