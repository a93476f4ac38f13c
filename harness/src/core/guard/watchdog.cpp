#include "watchdog.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "guarded_call.h"
#include "interruption.h"
#include "supervise.h"

namespace rehearse {

/// Signals are for the guarded thread, so the new thread begins with all of them blocked.
Watchdog::Watchdog() {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread([this] { watch(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void Watchdog::wake() {
  if (sleeps_.exchange(0) != 0) ::syscall(SYS_futex, &sleeps_, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

/// Returns when a call has begun after the number `calls`.
void Watchdog::sleep_after(std::uint64_t calls) {
  sleeps_.store(1);
  while (calls_.load() == calls && sleeps_.load() != 0)
    ::syscall(SYS_futex, &sleeps_, FUTEX_WAIT, 1, nullptr, nullptr, 0);
  sleeps_.store(0);
}

double Watchdog::look_period() const {
  constexpr double shortest = 0.01, longest = 0.1;  // [s]
  return std::clamp(limit_.load(std::memory_order_relaxed) / 10, shortest, longest);
}

void Watchdog::watch() {
  using clock = std::chrono::steady_clock;
  std::uint64_t seen = 0;
  clock::time_point since = clock::now();
  std::optional<clock::time_point> signalled;
  for (;;) {
    std::this_thread::sleep_for(std::chrono::duration<double>(look_period()));
    if (!signalled && interruption() != 0) signalled = clock::now();
    const std::uint64_t calls = calls_.load(std::memory_order_acquire);
    if (calls != seen) {
      seen = calls;
      since = clock::now();
      continue;
    }
    if (calls % 2 == 0) {
      sleep_after(calls);
      continue;
    }
    const auto seconds_from = [](clock::time_point past) {
      return std::chrono::duration<double>(clock::now() - past).count();
    };
    if (seconds_from(since) > limit_.load(std::memory_order_relaxed) ||
        (signalled && seconds_from(std::max(since, *signalled)) > limit_after_signal)) {
      if (!is_traced()) pthread_kill(thread_.load(std::memory_order_relaxed), hang_signal);
      since = clock::now();
    }
  }
}

}  // namespace rehearse
