// Watchdog: a thread that ends guarded calls which exceed their limit, unless a debugger has stopped the process.
//
// It uses wall time on purpose: this decides only whether a run continues, never its contents. The thread calls no
// function that takes a lock, and runs until the process ends. It looks at a tenth of the limit, at most every tenth of
// a second, and sleeps while no calls are made.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <cstdint>

namespace rehearse {

/// Ends a call that is late. The watchdog sends it, and the kernel if a CPU limit is set.
inline constexpr int hang_signal = SIGXCPU;

class Watchdog {
 public:
  static Watchdog& instance() {
    if (!watchdog_) watchdog_ = new Watchdog;
    return *watchdog_;
  }
  /// A forked process lacks its parent's watchdog thread.
  static void forget() { watchdog_ = nullptr; }

  /// A call of the thread begins, which may take so long [s].
  void begin(pthread_t thread, double limit) {
    thread_.store(thread, std::memory_order_relaxed);
    limit_.store(limit, std::memory_order_relaxed);
    calls_.fetch_add(1);  // odd: a call is running
    if (sleeps_.load() != 0) wake();
  }
  void end() { calls_.fetch_add(1, std::memory_order_release); }

 private:
  Watchdog();

  [[noreturn]] void watch();
  void wake();
  void sleep_after(std::uint64_t calls);
  double look_period() const;

  static inline Watchdog* watchdog_ = nullptr;
  std::atomic<std::uint64_t> calls_{0};
  std::atomic<double> limit_{0.0};
  std::atomic<pthread_t> thread_{};
  std::atomic<std::uint32_t> sleeps_{0};  // a futex: 1: no calls are made, and begin() has to wake the thread
};

}  // namespace rehearse
