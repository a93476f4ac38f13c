// Replacements of the C library's functions that end or change the whole process, or open files to read.
//
// The dynamic linker finds these first, because this library comes before libc in every program that links it. Outside
// of a guarded call they only call the functions of libc. In a guarded call, a function that would end the process ends
// the call. A function that would change the process makes ProcessGuard store its state first. Protected resources of a
// run are not changed (process_guard.h). A function that opens a file to read notes its name first (opened_files.h).
#undef _FORTIFY_SOURCE  // it declares inline functions with the names of those that open files
#include <cxxabi.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <locale.h>
#include <pthread.h>
#include <rehearse/diagnostic.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "cost_counter.h"
#include "exception_text.h"
#include "guarded_call.h"
#include "next_functions.h"
#include "opened_files.h"
#include "process_end.h"
#include "process_guard.h"
#include "turn_calls.h"

namespace {

using rehearse::HostCode;
using rehearse::ProcessGuard;
using rehearse::ThreadCount;

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define REHEARSE_ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define REHEARSE_ADDRESS_SANITIZER
#endif

void look() {
  const HostCode own;
  if (rehearse::in_guarded_call()) ProcessGuard::instance().before_change();
}

/// `process`: the process whose limit will be changed; 0: this one.
bool keeps_limits(pid_t process = 0) {
  const HostCode own;
  if (!rehearse::in_controllers_code() || (process != 0 && process != getpid())) return false;
  ProcessGuard::instance().note_limit();
  return true;
}

bool keeps_signal(int number) {
  const HostCode own;
  return rehearse::in_guarded_call() && ProcessGuard::instance().keeps_signal(number);
}

/// Returns if the process may end, or become a different program. `status`: of the exit; none for exec.
void end_only_the_call(const char* function, std::optional<int> status) {
  if (rehearse::is_forked_by_guest()) {
    if (status) rehearse::leave_process(*status);
    return;
  }
  if (!rehearse::in_controllers_code() && !rehearse::is_process_ending()) return;
  static thread_local char deed[64];
  if (status)
    std::snprintf(deed, sizeof deed, "called %s(%d)", function, *status);
  else
    std::snprintf(deed, sizeof deed, "called %s", function);
  rehearse::end_if_ending(deed);
  if (rehearse::in_guarded_call()) rehearse::leave_guarded_call(deed);
  ProcessGuard::instance().note_thread_exit(deed);
  // The thread can't be left as a call can, and the code after exit() must not run.
  if (rehearse::takes_turns()) rehearse::TurnScheduler::instance().stop_for_good("nothing: it was stopped for good");
  for (;;) pause();
}

void note(const char* path, int flags) {
  if ((flags & O_ACCMODE) != O_WRONLY && !(flags & O_TRUNC) && rehearse::in_guarded_call())
    rehearse::note_opened_file(path);
}

void note(const char* path, const char* mode) {
  if (mode && mode[0] == 'r' && rehearse::in_guarded_call()) rehearse::note_opened_file(path);
}

/// The mode of a file that may be created.
mode_t mode_in(int flags, va_list arguments) {
  const bool makes = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  return makes ? va_arg(arguments, mode_t) : 0;
}

/// In the parent: notes the fork. In the child: makes it end when the thread that forked it ends.
pid_t note_fork(pid_t parent, pid_t child) {
  const HostCode own;
  if (child > 0 && rehearse::in_controllers_code()) ProcessGuard::instance().note_fork();
  if (child == 0) rehearse::this_turn = nullptr;  // the other threads aren't in the child
  if (child == 0 && rehearse::is_forked_by_guest()) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) rehearse::leave_process(EXIT_FAILURE);  // the parent ended before the line above
  }
  return child;
}

/// The arguments of an execl(), with the null pointer at their end; for an execle() its environment as well.
struct ExecWords {
  std::vector<char*> words;
  char* const* environment = nullptr;

  ExecWords(const char* first, va_list more, bool has_environment) {
    for (const char* word = first; word; word = va_arg(more, const char*)) words.push_back(const_cast<char*>(word));
    words.push_back(nullptr);
    if (has_environment) environment = va_arg(more, char* const*);
  }
};

/// The set without the signals that end calls, if it contains them.
sigset_t without_ours(const sigset_t& set) {
  sigset_t rest = set;
  for (int number = 1; number < NSIG; ++number)
    if (sigismember(&rest, number) == 1 && rehearse::ends_calls(number)) sigdelset(&rest, number);
  return rest;
}

/// The data for a starting thread of a controller.
struct StartingThread {
  void* (*routine)(void*);
  void* argument;
  ThreadCount guest;
  rehearse::TurnThread* turn = nullptr;  // null: it takes no turns
};

/// Ends the turns of a thread after its own destructors and those of its keys: as the destructor of a key that is set
/// again in each round but the last.
class EndOfTurns {
 public:
  static void at_end_of(rehearse::TurnThread& turn) {
    static const EndOfTurns key;
    pthread_setspecific(key.key_, &turn);
  }

 private:
  EndOfTurns() { pthread_key_create(&key_, end); }
  static void end(void* given) {
    static thread_local int rounds = 0;
    if (++rounds < PTHREAD_DESTRUCTOR_ITERATIONS) return at_end_of(*static_cast<rehearse::TurnThread*>(given));
    const ThreadCount guest = rehearse::this_turn->guest;
    rehearse::own_threads = nullptr;
    --guest->running;
    rehearse::TurnScheduler::instance().end_thread();
  }
  pthread_key_t key_{};
};

void* run_counted(void* given) {
  const std::unique_ptr<StartingThread> start(static_cast<StartingThread*>(given));
  struct Counted {
    StartingThread& start;
    explicit Counted(StartingThread& of) : start(of) {
      rehearse::own_threads = start.turn ? &start.turn->guest : &start.guest;
      if (!start.turn) return;
      rehearse::TurnScheduler::instance().begin_thread(*start.turn);
      EndOfTurns::at_end_of(*start.turn);
    }
    ~Counted() {
      if (start.turn) return;  // it ends later
      rehearse::own_threads = nullptr;
      --start.guest->running;
    }
  } counted(*start);
  const rehearse::SignalStack signal_stack;
  char deed[512];
  try {
    void* const result = start->routine(start->argument);
    if (rehearse::is_forked_by_guest()) rehearse::leave_process(EXIT_FAILURE);
    return result;
  } catch (const abi::__forced_unwind&) {
    throw;  // exceptions of pthread_exit and pthread_cancel
  } catch (const std::exception& exception) {
    std::snprintf(deed, sizeof deed, "threw an exception that nobody catches: %s",
                  rehearse::text_of_controller(exception.what()).c_str());
  } catch (...) {
    std::snprintf(deed, sizeof deed, "threw something that nobody catches and that is no std::exception");
  }
  rehearse::fail_on_own_thread(deed);
}

/// The name of one of libraries_without_turns in which the function lies; null: in none.
const char* library_without_turns(const void* function) {
  dl_find_object object;
  if (_dl_find_object(const_cast<void*>(function), &object) != 0) return nullptr;
  const std::string_view file = object.dlfo_link_map->l_name;
  for (const char* name : rehearse::libraries_without_turns)
    if (file.substr(file.rfind('/') + 1).starts_with(name)) return name;
  return nullptr;
}

/// True if a thread that begins with the function takes turns.
bool will_take_turns(const ThreadCount& guest, const void* function) {
  if (guest->are_free || (!rehearse::takes_turns() && !rehearse::in_guarded_call())) return false;
  if (const char* library = library_without_turns(function)) {
    if (!guest->free_because) guest->free_because = library;
    return false;
  }
  return true;
}

bool is_detached(const pthread_attr_t* attributes) {
  int state = PTHREAD_CREATE_JOINABLE;
  return attributes && pthread_attr_getdetachstate(attributes, &state) == 0 && state == PTHREAD_CREATE_DETACHED;
}

}  // namespace

int rehearse::start_thread(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*), void* argument,
                           const void* function) {
  const ThreadCount guest = ProcessGuard::instance().threads_here();
  if (!guest) return REHEARSE_NEXT(pthread_create)(thread, attributes, routine, argument);
  rehearse::count_guarded(rehearse_counted_pthread_create);
  const HostCode own;
  auto& turns = rehearse::TurnScheduler::instance();
  auto start = std::make_unique<StartingThread>(StartingThread{routine, argument, guest});
  if (will_take_turns(guest, function)) {
    if (!rehearse::this_turn) turns.join_in(guest);
    start->turn = turns.add(guest, function);
  }
  ++guest->running;
  rehearse::TurnThread* const turn = start->turn;
  const int failed = rehearse::next_functions().pthread_create_(thread, attributes, run_counted, start.get());
  if (failed != 0) {
    --guest->running;
    if (turn) turns.forget(*turn);
    return failed;
  }
  static_cast<void>(start.release());  // the thread owns it now
  if (turn) turns.started(*turn, *thread, is_detached(attributes));
  return 0;
}

extern "C" {

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// A function that ends the process.
#define REHEARSE_EXIT(function, parameters) \
  void function parameters {                \
    end_only_the_call(#function, status);   \
    REHEARSE_NEXT(function)(status);        \
    __builtin_unreachable();                \
  }
REHEARSE_EXIT(exit, (int status) noexcept)
REHEARSE_EXIT(_exit, (int status))
REHEARSE_EXIT(_Exit, (int status) noexcept)
REHEARSE_EXIT(quick_exit, (int status) noexcept)

/// The C library's own aborts, as after damage of the heap, don't come here: only calls by other code, which holds none
/// of its locks.
void abort() noexcept {
  if ((rehearse::in_controllers_code() || rehearse::is_process_ending()) && !rehearse::is_forked_by_guest())
    rehearse::abort_controllers_code();
  REHEARSE_NEXT(abort)();
  __builtin_unreachable();
}

/// assert() of the C library, whose own abort would look like one after damage of the heap.
void __assert_fail(const char* assertion, const char* file, unsigned int line, const char* function) noexcept {
  std::fprintf(stderr, "%s: %s:%u: %s: Assertion `%s' failed.\n", program_invocation_short_name, file, line,
               function ? function : "?", assertion);
  std::fflush(stderr);
  abort();
}

/// A function that makes the process a different program.
#define REHEARSE_EXEC(function, parameters, arguments) \
  int function parameters noexcept {                   \
    end_only_the_call(#function, {});                  \
    return REHEARSE_NEXT(function) arguments;          \
  }
REHEARSE_EXEC(execve, (const char* file, char* const words[], char* const environment[]), (file, words, environment))
REHEARSE_EXEC(execv, (const char* file, char* const words[]), (file, words))
REHEARSE_EXEC(execvp, (const char* file, char* const words[]), (file, words))
REHEARSE_EXEC(execvpe, (const char* file, char* const words[], char* const environment[]), (file, words, environment))
REHEARSE_EXEC(fexecve, (int file, char* const words[], char* const environment[]), (file, words, environment))

/// Such a function whose words are its arguments. `call` passes them on as an array, `given`.
#define REHEARSE_EXEC_LIST(function, has_environment, call)         \
  int function(const char* file, const char* first, ...) noexcept { \
    end_only_the_call(#function, {});                               \
    va_list more;                                                   \
    va_start(more, first);                                          \
    const ExecWords given(first, more, has_environment);            \
    va_end(more);                                                   \
    return call;                                                    \
  }
REHEARSE_EXEC_LIST(execl, false, REHEARSE_NEXT(execv)(file, given.words.data()))
REHEARSE_EXEC_LIST(execlp, false, REHEARSE_NEXT(execvp)(file, given.words.data()))
REHEARSE_EXEC_LIST(execle, true, REHEARSE_NEXT(execve)(file, given.words.data(), given.environment))

pid_t fork() noexcept {
  const pid_t parent = getpid();
  return note_fork(parent, REHEARSE_NEXT(fork)());
}

/// As fork(): a caller of vfork() must not return before the child has ended, so the real vfork() can't be called here.
pid_t vfork() noexcept { return fork(); }

/// Passes on six words, as the C library does, whatever number the caller gave; AddressSanitizer would report the
/// missing ones.
__attribute__((no_sanitize("address"))) long syscall(long number, ...) noexcept {
  va_list more;
  va_start(more, number);
  long given[6];
  for (long& one : given) one = va_arg(more, long);
  va_end(more);
  if (number == SYS_exit_group) end_only_the_call("exit_group", static_cast<int>(given[0]));
  if (number == SYS_execve) end_only_the_call("execve", {});
#ifdef SYS_fork
  if (number == SYS_fork || number == SYS_vfork) return fork();
#endif
  long answered = 0;
  if (rehearse::takes_turns() && rehearse::answer_turn_call(number, given, answered)) return answered;
  const bool forks = number == SYS_clone && (given[0] & CLONE_VM) == 0;
  const pid_t parent = forks ? getpid() : 0;
  const long result = REHEARSE_NEXT(syscall)(number, given[0], given[1], given[2], given[3], given[4], given[5]);
  return forks ? note_fork(parent, static_cast<pid_t>(result)) : result;
}

#if !defined(REHEARSE_ADDRESS_SANITIZER)  // AddressSanitizer calls these before instrumented code can run
int setrlimit(__rlimit_resource_t resource, const rlimit* limit) noexcept {
  return keeps_limits() ? 0 : REHEARSE_NEXT(setrlimit)(resource, limit);
}

int setrlimit64(__rlimit_resource_t resource, const rlimit64* limit) noexcept {
  return keeps_limits() ? 0 : REHEARSE_NEXT(setrlimit64)(resource, limit);
}
#endif

int prlimit(pid_t process, __rlimit_resource resource, const rlimit* limit, rlimit* before) noexcept {
  return REHEARSE_NEXT(prlimit)(process, resource, limit && keeps_limits(process) ? nullptr : limit, before);
}

int prlimit64(pid_t process, __rlimit_resource resource, const rlimit64* limit, rlimit64* before) noexcept {
  return REHEARSE_NEXT(prlimit64)(process, resource, limit && keeps_limits(process) ? nullptr : limit, before);
}

/// A function that changes the process if `changes`; otherwise it is a query.
#define REHEARSE_CHANGE(result, function, parameters, arguments, changes) \
  result function parameters noexcept {                                   \
    if (changes) look();                                                  \
    return REHEARSE_NEXT(function) arguments;                             \
  }
REHEARSE_CHANGE(int, chdir, (const char* path), (path), true)
REHEARSE_CHANGE(int, fchdir, (int descriptor), (descriptor), true)
REHEARSE_CHANGE(mode_t, umask, (mode_t mask), (mask), true)
REHEARSE_CHANGE(char*, setlocale, (int category, const char* name), (category, name), name)
REHEARSE_CHANGE(locale_t, uselocale, (locale_t locale), (locale), locale)
REHEARSE_CHANGE(int, setenv, (const char* name, const char* value, int overwrite), (name, value, overwrite), true)
REHEARSE_CHANGE(int, unsetenv, (const char* name), (name), true)
REHEARSE_CHANGE(int, putenv, (char* variable), (variable), true)
REHEARSE_CHANGE(int, clearenv, (), (), true)
REHEARSE_CHANGE(unsigned int, alarm, (unsigned int seconds), (seconds), true)
REHEARSE_CHANGE(int, setitimer, (__itimer_which_t which, const itimerval* value, itimerval* before),
                (which, value, before), true)

int sigaction(int number, const struct sigaction* action, struct sigaction* before) noexcept {
  if (action && keeps_signal(number)) action = nullptr;
  if (action) look();
  const int failed = REHEARSE_NEXT(sigaction)(number, action, before);
  if (action) ProcessGuard::note_change_of_actions();
  return failed;
}

sighandler_t signal(int number, sighandler_t handler) noexcept {
  if (keeps_signal(number)) return SIG_DFL;
  look();
  const sighandler_t before = REHEARSE_NEXT(signal)(number, handler);
  ProcessGuard::note_change_of_actions();
  return before;
}

/// A function that changes the mask of signals.
#define REHEARSE_MASK(function)                                                                                       \
  int function(int how, const sigset_t* set, sigset_t* before) noexcept {                                             \
    if (!set || how == SIG_UNBLOCK || !rehearse::in_guarded_call()) return REHEARSE_NEXT(function)(how, set, before); \
    look();                                                                                                           \
    const sigset_t rest = without_ours(*set);                                                                         \
    return REHEARSE_NEXT(function)(how, &rest, before);                                                               \
  }
REHEARSE_MASK(pthread_sigmask)
REHEARSE_MASK(sigprocmask)

#define REHEARSE_OPEN(function)                        \
  int function(const char* path, int flags, ...) {     \
    va_list arguments;                                 \
    va_start(arguments, flags);                        \
    const mode_t mode = mode_in(flags, arguments);     \
    va_end(arguments);                                 \
    note(path, flags);                                 \
    return REHEARSE_NEXT(function)(path, flags, mode); \
  }
REHEARSE_OPEN(open)
REHEARSE_OPEN(open64)

#define REHEARSE_OPENAT(function)                              \
  int function(int folder, const char* path, int flags, ...) { \
    va_list arguments;                                         \
    va_start(arguments, flags);                                \
    const mode_t mode = mode_in(flags, arguments);             \
    va_end(arguments);                                         \
    if (folder == AT_FDCWD) note(path, flags);                 \
    return REHEARSE_NEXT(function)(folder, path, flags, mode); \
  }
REHEARSE_OPENAT(openat)
REHEARSE_OPENAT(openat64)

#define REHEARSE_FOPEN(function)                       \
  FILE* function(const char* path, const char* mode) { \
    note(path, mode);                                  \
    return REHEARSE_NEXT(function)(path, mode);        \
  }
REHEARSE_FOPEN(fopen)
REHEARSE_FOPEN(fopen64)

// NOLINTEND(bugprone-macro-parentheses)

/// For the interposer: true if a thread that begins with the function would take turns.
__attribute__((visibility("default"))) bool rehearse_will_take_turns(const void* function) {
  const ThreadCount guest = ProcessGuard::instance().threads_here();
  return guest && will_take_turns(guest, function);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*),
                   void* argument) noexcept {
  return rehearse::start_thread(thread, attributes, routine, argument, reinterpret_cast<const void*>(routine));
}

}  // extern "C"
