// The functions of the C library that end or change the whole process, in front of its own.
//
// The dynamic linker finds these first, because this library comes before libc in whatever links it. Outside of a
// guarded call they do what libc's do. In one, a function that would end the process ends the call; one that would
// change the process has ProcessGuard look first; what a run stands on is not given away (process_guard.h).
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <pthread.h>
#include <rehearse/diagnostic.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "guarded_call.h"
#include "process_guard.h"

namespace {

using rehearse::ProcessGuard;
using rehearse::ThreadCount;

/// The functions that would be found without ours. They are looked up when this library is loaded: a look-up takes the
/// lock of the dynamic linker, which a call that was ended while a library was loaded or unloaded holds for ever. No
/// template: clang gives the types of functions that return and of those that don't one name.
#define REHEARSE_TRIPWIRES(FUNCTION)                                                                                   \
  FUNCTION(exit) FUNCTION(_exit) FUNCTION(_Exit) FUNCTION(quick_exit) FUNCTION(chdir) FUNCTION(fchdir)                 \
  FUNCTION(umask) FUNCTION(setlocale) FUNCTION(uselocale) FUNCTION(setenv) FUNCTION(unsetenv) FUNCTION(putenv)         \
  FUNCTION(clearenv) FUNCTION(alarm) FUNCTION(setitimer) FUNCTION(sigaction) FUNCTION(signal)                          \
  FUNCTION(pthread_sigmask) FUNCTION(sigprocmask) FUNCTION(close) FUNCTION(dup2) FUNCTION(dup3) FUNCTION(fclose)       \
  FUNCTION(close_range) FUNCTION(closefrom) FUNCTION(pthread_create)

struct NextFunctions {
#define REHEARSE_MEMBER(function) \
  decltype(&(::function)) function##_ = reinterpret_cast<decltype(&(::function))>(dlsym(RTLD_NEXT, #function));
  REHEARSE_TRIPWIRES(REHEARSE_MEMBER)
#undef REHEARSE_MEMBER
};

const NextFunctions& next_functions() {
  static const NextFunctions all;
  return all;
}
[[maybe_unused]] const NextFunctions& looked_up_at_loading = next_functions();

#define NEXT(function) next_functions().function##_

void look() {
  if (rehearse::in_guarded_call()) ProcessGuard::instance().before_change();
}

bool keeps(int descriptor) {
  return (rehearse::in_guarded_call() || rehearse::own_threads) && ProcessGuard::instance().keeps(descriptor);
}

bool keeps_signal(int number) { return rehearse::in_guarded_call() && ProcessGuard::instance().keeps_signal(number); }

/// Comes back if the process shall end.
void end_only_the_call(const char* function, int status) {
  rehearse::end_if_ending();
  if (rehearse::in_guarded_call()) rehearse::leave_guarded_call(function, status);
  if (!rehearse::own_threads) return;
  ProcessGuard::instance().note_thread_exit(function, status);
  for (;;) pause();  // it can't be left as a call can, and what comes after exit() is not meant to run
}

/// Without the signals that end calls, if they were to be blocked.
sigset_t without_ours(const sigset_t& set) {
  sigset_t rest = set;
  for (int number = 1; number < NSIG; ++number)
    if (sigismember(&rest, number) == 1 && rehearse::ends_calls(number)) sigdelset(&rest, number);
  return rest;
}

/// A thread of a controller's, on its way to its own beginning.
struct StartingThread {
  void* (*routine)(void*);
  void* argument;
  ThreadCount count;
};

void* run_counted(void* given) {
  const std::unique_ptr<StartingThread> start(static_cast<StartingThread*>(given));
  struct Counted {
    ThreadCount count;
    explicit Counted(ThreadCount of) : count(std::move(of)) { rehearse::own_threads = &count; }
    ~Counted() {
      rehearse::own_threads = nullptr;
      --*count;
    }
  } counted(start->count);
  return start->routine(start->argument);
}

}  // namespace

extern "C" {

void exit(int status) noexcept {
  end_only_the_call("exit", status);
  NEXT(exit)(status);
  __builtin_unreachable();
}

void _exit(int status) {
  end_only_the_call("_exit", status);
  NEXT(_exit)(status);
  __builtin_unreachable();
}

void _Exit(int status) noexcept {
  end_only_the_call("_Exit", status);
  NEXT(_Exit)(status);
  __builtin_unreachable();
}

void quick_exit(int status) noexcept {
  end_only_the_call("quick_exit", status);
  NEXT(quick_exit)(status);
  __builtin_unreachable();
}

int chdir(const char* path) noexcept {
  look();
  return NEXT(chdir)(path);
}

int fchdir(int descriptor) noexcept {
  look();
  return NEXT(fchdir)(descriptor);
}

mode_t umask(mode_t mask) noexcept {
  look();
  return NEXT(umask)(mask);
}

char* setlocale(int category, const char* name) noexcept {
  if (name) look();
  return NEXT(setlocale)(category, name);
}

locale_t uselocale(locale_t locale) noexcept {
  if (locale) look();
  return NEXT(uselocale)(locale);
}

int setenv(const char* name, const char* value, int overwrite) noexcept {
  look();
  return NEXT(setenv)(name, value, overwrite);
}

int unsetenv(const char* name) noexcept {
  look();
  return NEXT(unsetenv)(name);
}

int putenv(char* variable) noexcept {
  look();
  return NEXT(putenv)(variable);
}

int clearenv() noexcept {
  look();
  return NEXT(clearenv)();
}

unsigned int alarm(unsigned int seconds) noexcept {
  look();
  return NEXT(alarm)(seconds);
}

int setitimer(__itimer_which_t which, const itimerval* value, itimerval* before) noexcept {
  look();
  return NEXT(setitimer)(which, value, before);
}

int sigaction(int number, const struct sigaction* action, struct sigaction* before) noexcept {
  if (action && keeps_signal(number)) action = nullptr;
  if (action) look();
  return NEXT(sigaction)(number, action, before);
}

sighandler_t signal(int number, sighandler_t handler) noexcept {
  if (keeps_signal(number)) return SIG_DFL;
  look();
  return NEXT(signal)(number, handler);
}

int pthread_sigmask(int how, const sigset_t* set, sigset_t* before) noexcept {
  if (!set || how == SIG_UNBLOCK || !rehearse::in_guarded_call()) return NEXT(pthread_sigmask)(how, set, before);
  look();
  const sigset_t rest = without_ours(*set);
  return NEXT(pthread_sigmask)(how, &rest, before);
}

int sigprocmask(int how, const sigset_t* set, sigset_t* before) noexcept {
  if (!set || how == SIG_UNBLOCK || !rehearse::in_guarded_call()) return NEXT(sigprocmask)(how, set, before);
  look();
  const sigset_t rest = without_ours(*set);
  return NEXT(sigprocmask)(how, &rest, before);
}

int close(int descriptor) {
  if (keeps(descriptor)) return errno = EBADF, -1;
  return NEXT(close)(descriptor);
}

int dup2(int from, int to) noexcept {
  if (from != to && keeps(to)) return errno = EBUSY, -1;
  return NEXT(dup2)(from, to);
}

int dup3(int from, int to, int flags) noexcept {
  if (from != to && keeps(to)) return errno = EBUSY, -1;
  return NEXT(dup3)(from, to, flags);
}

int fclose(FILE* stream) {
  if (rehearse::in_guarded_call() && stream && keeps(fileno(stream))) {
    fflush(stream);
    return errno = EBADF, EOF;
  }
  return NEXT(fclose)(stream);
}

int close_range(unsigned int first, unsigned int last, int flags) noexcept {
  if (!rehearse::in_guarded_call() || flags != 0) return NEXT(close_range)(first, last, flags);
  unsigned int from = first;
  for (const unsigned int kept : ProcessGuard::instance().kept_in(first, last)) {
    if (kept > from && NEXT(close_range)(from, kept - 1, 0) != 0) return -1;
    from = kept + 1;
  }
  return from <= last ? NEXT(close_range)(from, last, 0) : 0;
}

void closefrom(int first) noexcept {
  if (!rehearse::in_guarded_call()) return NEXT(closefrom)(first);
  close_range(static_cast<unsigned int>(std::max(first, 0)), ~0U, 0);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*),
                   void* argument) noexcept {
  const ThreadCount count = ProcessGuard::instance().threads_here();
  if (!count) return NEXT(pthread_create)(thread, attributes, routine, argument);
  auto start = std::make_unique<StartingThread>(StartingThread{routine, argument, count});
  ++*count;
  const int failed = NEXT(pthread_create)(thread, attributes, run_counted, start.get());
  if (failed != 0)
    --*count;
  else
    static_cast<void>(start.release());  // the thread's
  return failed;
}

}  // extern "C"
