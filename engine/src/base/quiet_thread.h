// Threads that get no signals from outside. Internal.
#pragma once

#include <csignal>
#include <functional>
#include <semaphore>
#include <thread>
#include <utility>

namespace rehearse {

/// Alarms and interrupts are for the program's own threads. SIGBUS is delivered: a mapped file may be truncated.
template <class Function>
std::thread start_quiet_thread(Function function) {
  sigset_t all, before;
  sigfillset(&all);
  sigdelset(&all, SIGBUS);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(function));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

/// Calls one function in a thread of its own, once for each begin(). The thread starts with the first call.
class QuietWorker {
 public:
  explicit QuietWorker(std::function<void()> work) : work_(std::move(work)) {}
  ~QuietWorker() {
    while (pending_ > 0) finish();
    ending_ = true;
    begin_.release();
    if (thread_.joinable()) thread_.join();
  }
  QuietWorker(const QuietWorker&) = delete;
  QuietWorker& operator=(const QuietWorker&) = delete;

  /// Requests a call. It begins when the calls before it have ended.
  void begin() {
    if (!thread_.joinable()) thread_ = start_quiet_thread([this] { run(); });
    ++pending_;
    begin_.release();
  }
  /// The number of begin() without their finish().
  int pending() const { return pending_; }
  /// Waits for the end of the earliest pending call.
  void finish() {
    end_.acquire();
    --pending_;
  }

 private:
  void run() {
    for (begin_.acquire(); !ending_; begin_.acquire()) {
      work_();
      end_.release();
    }
  }

  const std::function<void()> work_;
  int pending_ = 0;      // used by the owner's thread
  bool ending_ = false;  // written before the last release of begin_
  std::counting_semaphore<> begin_{0}, end_{0};
  std::thread thread_;
};

}  // namespace rehearse
