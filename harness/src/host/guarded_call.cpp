#include "guarded_call.h"

#include <cxxabi.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <rehearse/diagnostic.h>
#include <setjmp.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <thread>
#include <typeinfo>

namespace rehearse {
namespace {

constexpr int caught_signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr int hang_signal = SIGXCPU;  // sent by the watchdog; nobody else sends it unless a CPU limit is set
constexpr int exit_instead = -1;      // at the return point, in the place of a signal
constexpr std::size_t signal_stack_size = 64 * 1024;

sigjmp_buf return_point;
volatile sig_atomic_t guarding = 0;
pthread_t guarded_thread;
const char* exit_function = nullptr;  // how the code of the last call wanted to end the process
int exit_status = 0;
struct sigaction outside_actions[NSIG];  // as they were before ours

volatile sig_atomic_t ending = 0;  // the process: what remains of it runs in exit()
int end_status = 0;

extern "C" void leave_guarded_code(int signal_number) {
  if (in_guarded_call()) {
    guarding = 0;
    siglongjmp(return_point, signal_number);
  }
  end_if_ending();
  if (signal_number == hang_signal) return;  // it came too late: the call has returned
  // A crash outside of guarded code is not ours to hide: whoever handled it before gets it when the fault repeats.
  sigaction(signal_number, &outside_actions[signal_number], nullptr);
  if (signal_number == SIGABRT) raise(SIGABRT);
}

/// A debugger looks at this process (or another tracer, as strace). Allocates nothing and takes no lock: the code that
/// hangs may hold any, that of the dynamic linker included.
bool is_traced() {
  const int status = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  if (status < 0) return false;
  char text[4096] = {};
  const ssize_t size = read(status, text, sizeof text - 1);
  close(status);
  constexpr const char* key = "\nTracerPid:\t";
  const char* tracer = size > 0 ? std::strstr(text, key) : nullptr;
  return tracer && tracer[std::strlen(key)] != '0';
}

/// Watches from a thread of its own that no guarded call takes longer than its limit, unless a debugger holds it. This is wall time on purpose: it
/// decides only whether a run goes on, never what is in it. The thread calls nothing that takes a lock, and runs until
/// the process ends.
class Watchdog {
 public:
  static Watchdog& instance() {
    static auto& watchdog = *new Watchdog;
    return watchdog;
  }

  void begin(double limit) {
    limit_.store(limit, std::memory_order_relaxed);
    calls_.fetch_add(1, std::memory_order_release);  // odd: a call is under way
  }
  void end() { calls_.fetch_add(1, std::memory_order_release); }

 private:
  /// Signals are for the guarded thread, so the new one begins with all of them blocked.
  Watchdog() {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread([this] { watch(); }).detach();
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  [[noreturn]] void watch() {
    using clock = std::chrono::steady_clock;
    std::uint64_t seen = 0;
    clock::time_point since = clock::now();
    for (;;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const std::uint64_t calls = calls_.load(std::memory_order_acquire);
      if (calls != seen) {
        seen = calls;
        since = clock::now();
        continue;
      }
      const bool under_way = calls % 2 == 1;
      const std::chrono::duration<double> age = clock::now() - since;
      if (under_way && age.count() > limit_.load(std::memory_order_relaxed)) {
        if (!is_traced()) pthread_kill(guarded_thread, hang_signal);
        since = clock::now();
      }
    }
  }

  std::atomic<std::uint64_t> calls_{0};
  std::atomic<double> limit_{0.0};
};

/// The signal stack of this thread, so that an overflow of its ordinary one can be survived. It is there as long as the
/// process: exit() ends a thread's own objects first.
void provide_signal_stack() {
  thread_local char* stack = nullptr;
  if (stack) return;
  stack = new char[signal_stack_size];
  stack_t alternate{};
  alternate.ss_sp = stack;
  alternate.ss_size = signal_stack_size;
  sigaltstack(&alternate, nullptr);
}

constexpr double end_limit = 10.0;  // [s] for all that a process still does in exit()

/// In exit(): what follows may be static destructors of a library that stays in memory. They change nothing any more.
extern "C" void guard_rest(int status, void*) {
  if (ending) return;
  std::fflush(nullptr);
  end_status = status;
  ending = 1;
  guarded_thread = pthread_self();
  provide_signal_stack();
  Watchdog::instance().begin(end_limit);
}

void install_handlers() {
  static bool installed = false;
  if (installed) return;
  installed = true;
  struct sigaction action {};
  action.sa_handler = leave_guarded_code;
  // SA_NODEFER: the signal isn't blocked when the handler is left by siglongjmp
  action.sa_flags = SA_ONSTACK | SA_NODEFER;
  for (const int signal_number : caught_signals) sigaction(signal_number, &action, &outside_actions[signal_number]);
  sigaction(hang_signal, &action, &outside_actions[hang_signal]);
}

std::string describe_signal(int signal_number) {
  switch (signal_number) {
    case SIGSEGV:
      return "crashed: segmentation fault (an access to memory that isn't there, as through a null pointer)";
    case SIGBUS: return "crashed: bus error";
    case SIGFPE: return "crashed: arithmetic fault (as a division of an integer by zero)";
    case SIGILL: return "crashed: illegal instruction";
    case SIGABRT: return "crashed: it called abort, or an assertion of its own failed";
    default: return "crashed: signal " + std::to_string(signal_number);
  }
}

std::string demangled(const char* name) {
  int status = 0;
  char* text = abi::__cxa_demangle(name, nullptr, nullptr, &status);
  std::string result = status == 0 && text ? text : name;
  std::free(text);
  return result;
}

/// Runs the code and catches what it throws.
void run_catching(const std::function<void()>& code, CallOutcome& outcome) {
  try {
    code();
  } catch (const std::exception& exception) {
    outcome.end = CallEnd::threw;
    outcome.what = "threw " + demangled(typeid(exception).name()) + ": " + exception.what();
  } catch (...) {
    outcome.end = CallEnd::threw;
    outcome.what = "threw something that is no std::exception";
    if (const std::type_info* type = abi::__cxa_current_exception_type())
      outcome.what += ": " + demangled(type->name());
  }
}

}  // namespace

void prepare_guarded_calls() { install_handlers(); }

void guard_process_end() { on_exit(guard_rest, nullptr); }

void end_if_ending() {
  if (ending) syscall(SYS_exit_group, end_status);
}

CallOutcome guarded_call(const std::function<void()>& code, double limit) {
  REHEARSE_ASSERT(!guarding, "guarded calls don't nest");
  install_handlers();
  provide_signal_stack();
  guarded_thread = pthread_self();
  const FloatMode standard, mode_before = float_mode();
  if (!(mode_before == standard)) set_float_mode(standard);
  CallOutcome outcome;
  Watchdog::instance().begin(limit);
  const int signal_number = sigsetjmp(return_point, 0);
  if (signal_number == 0) {
    guarding = 1;
    run_catching(code, outcome);
    guarding = 0;
  } else {
    outcome.end = signal_number == exit_instead  ? CallEnd::exited
                  : signal_number == hang_signal ? CallEnd::hung
                                                 : CallEnd::crashed;
  }
  Watchdog::instance().end();
  outcome.float_mode = float_mode();
  outcome.changed_float_mode = !(outcome.float_mode == standard);
  if (!(outcome.float_mode == mode_before)) set_float_mode(mode_before);
  if (outcome.end == CallEnd::hung)
    outcome.what = fmt::format("did not return within {} s", limit);
  else if (outcome.end == CallEnd::crashed)
    outcome.what = describe_signal(signal_number);
  else if (outcome.end == CallEnd::exited)
    outcome.what = fmt::format("called {}({})", exit_function, exit_status);
  return outcome;
}

bool in_guarded_call() { return guarding && pthread_equal(pthread_self(), guarded_thread); }

bool ends_calls(int signal_number) {
  return signal_number == hang_signal ||
         std::find(std::begin(caught_signals), std::end(caught_signals), signal_number) != std::end(caught_signals);
}

void leave_guarded_call(const char* function, int status) {
  REHEARSE_ASSERT(in_guarded_call(), "there is a call to leave");
  exit_function = function;
  exit_status = status;
  guarding = 0;
  siglongjmp(return_point, exit_instead);
}

}  // namespace rehearse
