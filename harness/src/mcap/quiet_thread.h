// Threads that help a reader or a writer. Internal.
#pragma once

#include <csignal>
#include <thread>
#include <utility>

namespace rehearse::mcap {

/// Starts a thread that no signal is delivered to: alarms and interrupts belong to the program's own threads. But for
/// SIGBUS, by which a mapped file says that it was cut: that is of the thread that reads.
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

}  // namespace rehearse::mcap
