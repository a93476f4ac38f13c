// start_quiet_thread: a thread that gets no signals from outside. Internal.
#pragma once

#include <csignal>
#include <thread>
#include <utility>

namespace rehearse::mcap {

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

}  // namespace rehearse::mcap
