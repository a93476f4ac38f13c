#include "interruption.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "base/clock.h"
#include "guarded_call.h"
#include "process_end.h"
#include "result_stream.h"
#include "supervisor.h"

namespace rehearse {
namespace {

volatile sig_atomic_t came = 0;
volatile time_t came_at = 0;  // time of the signal [s]

/// Whether the process that started this program ignores SIGPIPE, as services do: controllers expect that of their
/// writes.
const bool ignored_broken_pipes = [] {
  struct sigaction at_start {};
  return sigaction(SIGPIPE, nullptr, &at_start) == 0 && at_start.sa_handler == SIG_IGN;
}();

time_t seconds_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec;
}

void end_by(int number) {
  signal(number, SIG_DFL);
  raise(number);
}

/// A controller that prints in a run gets this signal: the run ends at the next tick, with a closed trace. Everywhere
/// else it ends the process, as it does programs that don't handle it.
extern "C" void take_broken_pipe(int number) {
  if (ignored_broken_pipes && in_guarded_call() && !is_reader_gone()) return;
  if (!in_guarded_call() || !is_reader_gone()) return end_by(number);
  if (came == 0) came = number;
}

/// A signal may arrive twice at the same time: from a terminal's or a time limit's process group, and from the parent.
extern "C" void take_interruption(int number, siginfo_t* sent, void*) {
  if (sent->si_code <= 0 && is_own_run(sent->si_pid)) return;       // a controller sent it to its parent
  const bool own = sent->si_code <= 0 && sent->si_pid == getpid();  // a controller sent it to its own process
  if (own || is_forked_by_guest() || is_process_ending()) {
    end_by(number);
  } else if (came == 0) {
    came_at = seconds_now();
    came = number;
  } else if (seconds_now() - came_at > 1) {
    end_by(number);
  }
}

}  // namespace

void end_runs_on_signals() {
  struct sigaction action {};
  action.sa_sigaction = take_interruption;
  action.sa_flags = SA_RESTART | SA_SIGINFO;
  for (const int number : {SIGINT, SIGTERM}) sigaction(number, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it
  signal(SIGPIPE, take_broken_pipe);
}

bool is_reader_gone() {
  pollfd outputs[] = {{STDOUT_FILENO, 0, 0}, {STDERR_FILENO, 0, 0}, {result_descriptor(), 0, 0}};  // poll() ignores -1
  return poll(outputs, std::size(outputs), 0) > 0 &&
         std::ranges::any_of(outputs, [](const pollfd& output) { return (output.revents & POLLERR) != 0; });
}

void end_if_reader_is_gone() {
  if (came == SIGPIPE) end_by(SIGPIPE);
}

int interruption() { return came; }

std::optional<Diagnostic> interrupted_at(std::int64_t tick, double time_step) {
  if (came == 0) return std::nullopt;
  return error(
      fmt::format("interrupted by SIG{} before tick {} ({} s)", sigabbrev_np(came), tick, time_of(tick, time_step)));
}

}  // namespace rehearse
