#include "supervisor.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <pthread.h>
#include <rehearse/pin.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "base/hashing.h"
#include "c_library.h"
#include "child_process.h"
#include "core/keeper/remote_writer.h"
#include "core/keeper/ring.h"
#include "core/keeper/trace_keeper.h"
#include "guarded_call.h"
#include "interruption.h"
#include "process_end.h"
#include "source_line.h"
#include "streams.h"
#include "supervise.h"
#include "supervisor_notes.h"

namespace rehearse {
namespace {

constexpr int controller_failed = 3;                  // the exit status
constexpr double patience = 0.5;                      // time for a child to end a call that took too long [s]
constexpr timespec child_look_period{0, 50'000'000};  // at which the child is looked at
constexpr double longest_look = 1.0;                  // after a longer interval this process was stopped [s]

Notes* notes = nullptr;  // null: this process has no supervisor
bool forks_run = false;  // the present fork has this process's supervisor
pid_t present_run = 0;   // a child of this process; 0: none

std::function<void(const std::string&)> tell_failure;

void note_place(const void* place) {
  notes->library[0] = '\0';
  dl_find_object object;
  if (!place || _dl_find_object(const_cast<void*>(place), &object) != 0) return;
  put(notes->library, object.dlfo_link_map->l_name);
  notes->address = reinterpret_cast<std::uintptr_t>(place) - object.dlfo_link_map->l_addr;
}

constexpr const char* at_the_end = "while its static objects were destroyed";

/// True if a debugger traces the child.
bool is_traced_by_other(pid_t child) {
  std::ifstream status(fmt::format("/proc/{}/status", child));
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("TracerPid:")) {
      const long tracer = std::atol(line.c_str() + line.find(':') + 1);
      return tracer != 0 && tracer != getpid();
    }
  return false;
}

/// The waiting parent.
class Parent {
 public:
  Parent(pid_t child, Ring& ring) : child_(child), keeper_(ring) {}
  [[noreturn]] void run();

 private:
  bool has_ended();
  pid_t runner() const;
  void give_terminal();
  void pass_on(const siginfo_t& signal);
  void stop_with_child();
  bool look_at_call();
  void look_for_hang();
  void look_at_memory();
  void kill_child();
  bool was_interrupted() const;
  bool lost_its_reader() const;
  [[noreturn]] void leave_announced();
  [[noreturn]] void leave(int status);
  [[noreturn]] void mirror();
  void find_line();
  std::string sentence() const;
  std::string close_traces();

  const pid_t child_;
  TraceKeeper keeper_;
  int ended_ = 0;        // as returned by waitpid()
  sigset_t received_{};  // signals from outside
  std::uint64_t calls_ = 0;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now(), looked_ = since_;
  std::string line_;            // "walk.cpp:42: ", of the code that failed; empty: not known
  NotedCall call_;              // the last whose seal was right
  bool gave_terminal_ = false;  // the terminal signals the child, not this process
  bool hung_ = false;
  int interrupted_ = 0;  // the first signal from outside that ends runs; 0: none
  std::chrono::steady_clock::time_point interrupted_at_;
  bool damaged_ = false;  // a controller has written into memory that this process reads
  const double default_memory_limit_ = default_memory_limit();  // [bytes]
  double memory_limit_ = 0.0;                                   // the limit that the child exceeded [bytes]
};

void Parent::run() {
  sigset_t all;
  sigfillset(&all);
  sigemptyset(&received_);
  while (!has_ended()) {
    siginfo_t signal{};
    const int number = sigtimedwait(&all, &signal, &child_look_period);
    if (number == SIGTSTP || number == SIGTTIN || number == SIGTTOU)
      stop_with_child();
    else if (number > 0 && number != SIGCHLD)
      pass_on(signal);
    if (keeper_.is_damaged()) kill_child();
    look_for_hang();
    look_at_memory();
  }
  for (siginfo_t signal{}; sigtimedwait(&all, &signal, std::array<timespec, 1>{}.data()) > 0;)
    sigaddset(&received_, signal.si_signo);
  kill(-child_, SIGKILL);  // processes that a controller forked
  keeper_.finish();
  damaged_ = keeper_.is_damaged() || (!look_at_call() && notes->calls != 0);
  if (lost_its_reader()) {
    static_cast<void>(close_traces());
    mirror();
  }
  if (notes->announced == regular_end && !damaged_) leave_announced();
  if (!damaged_ && (notes->calls == 0 || was_interrupted())) mirror();
  find_line();
  std::string text = "error: " + sentence() + "\n";
  if (!damaged_ && notes->task[0] != '\0')
    text += fmt::format("error: it was in {}; {} not run\n", text_of(notes->task),
                        notes->tasks_left == 1 ? "1 after it was" : fmt::format("{} after it were", notes->tasks_left));
  text += close_traces();
  std::fputs(text.c_str(), stderr);
  if (tell_failure) tell_failure(sentence());
  const bool is_late = hung_ || notes->hung == 1;
  leave(is_late && interrupted_ != 0 ? 128 + interrupted_ : controller_failed);
}

bool Parent::has_ended() {
  pid_t ended = 0;
  do ended = waitpid(child_, &ended_, WNOHANG | WUNTRACED);
  while (ended < 0 && errno == EINTR);
  if (ended != child_ || !WIFSTOPPED(ended_)) return ended == child_ || ended < 0;
  if (WSTOPSIG(ended_) == SIGTTIN || WSTOPSIG(ended_) == SIGTTOU) give_terminal();
  if (WSTOPSIG(ended_) == SIGTSTP && gave_terminal_) stop_with_child();
  return false;
}

/// The child reads from the terminal, or changes its settings: then it needs the place of this process there.
void Parent::give_terminal() {
  if (tcgetpgrp(STDIN_FILENO) != getpgrp()) return stop_with_child();  // a job in the background waits
  gave_terminal_ = tcsetpgrp(STDIN_FILENO, child_) == 0;
  kill(-child_, SIGCONT);
}

/// The child is in a process group of its own, so that a controller's signal to its group doesn't reach this process.
/// So signals of the terminal don't reach the child.
void Parent::pass_on(const siginfo_t& signal) {
  const pid_t runner = this->runner();
  if (signal.si_code <= 0 && (signal.si_pid == child_ || signal.si_pid == runner)) return;
  sigaddset(&received_, signal.si_signo);
  const int number = signal.si_signo;
  if (interrupted_ == 0 && (number == SIGINT || number == SIGTERM || number == SIGHUP)) {
    interrupted_ = number;
    interrupted_at_ = std::chrono::steady_clock::now();
  }
  kill(child_, signal.si_signo);
  if (runner != child_) kill(runner, signal.si_signo);
}

/// The process that runs the controllers: the child, or a child of its own. A guest may have written into the notes.
pid_t Parent::runner() const {
  const pid_t run = notes->run;
  return run > 0 && getpgid(run) == child_ ? run : child_;
}

/// The shell waits until this process has stopped, and continues it.
void Parent::stop_with_child() {
  kill(-child_, SIGSTOP);
  raise(SIGSTOP);
  kill(-child_, SIGCONT);
}

/// A controller has nothing more to say about the result: what it does in exit() is a warning.
void Parent::leave_announced() {
  if (was_interrupted()) mirror();
  const int status = WIFEXITED(ended_) ? WEXITSTATUS(ended_) : controller_failed;
  if (status == notes->status || notes->hung == 1) leave(notes->status);
  if (call_.function != std::string_view(destroying)) leave(status != 0 ? status : notes->status);
  std::fputs(("warning: " + sentence() + "\n").c_str(), stderr);
  leave(WIFEXITED(ended_) && notes->checks_leaks == 1 ? status : notes->status);
}

/// The group, because a controller may have forked.
void Parent::kill_child() { kill(-child_, SIGKILL); }

/// False if a controller has written over the notes.
bool Parent::look_at_call() {
  const std::uint32_t latest = notes->latest;
  for (const std::uint32_t index : {latest, latest + 1}) {
    const SealedCall noted = notes->last_calls[index % notes->last_calls.size()];
    if (noted.seal != noted.right_seal()) continue;
    call_ = noted.call;
    return true;
  }
  return false;
}

/// Kills a child with a hanging call. The child ends such a call itself, unless its controller disabled the signal for
/// that, is stopped, or waits in the C library.
void Parent::look_for_hang() {
  const std::uint64_t calls = notes->calls;
  const auto now = std::chrono::steady_clock::now();
  const auto seconds_since = [now](auto past) { return std::chrono::duration<double>(now - past).count(); };
  if (calls != calls_ || calls % 2 == 0 || seconds_since(std::exchange(looked_, now)) > longest_look) {
    calls_ = calls;
    since_ = now;
    looked_ = now;
  }
  const double age = seconds_since(since_);
  const bool is_late =
      interrupted_ != 0 && std::min(age, seconds_since(interrupted_at_)) > limit_after_signal + patience;
  if (!look_at_call() || (age < call_.limit + patience && !is_late)) return;
  if (is_traced_by_other(child_) || is_traced_by_other(runner())) return;
  if (call_.function != std::string_view(destroying)) {
    hung_ = true;
    return kill_child();
  }
  notes->hung = 1;  // its result is there, and the process that waits for it goes on
  std::fputs(("warning: " + sentence() + "\n").c_str(), stderr);
  since_ = now;
  kill(runner(), SIGKILL);
}

void Parent::look_at_memory() {
  const double stated = notes->memory_limit, limit = stated > 0.0 ? stated : default_memory_limit_;
  if (memory_limit_ > 0.0 || memory_of(runner()) <= limit) return;
  memory_limit_ = limit;
  kill_child();
}

/// True if both processes were interrupted by the same sender.
bool Parent::was_interrupted() const {
  if (!WIFSIGNALED(ended_)) return false;
  const int number = WTERMSIG(ended_);
  const bool of_terminal = number == SIGINT || number == SIGQUIT;
  return (of_terminal || number == SIGTERM || number == SIGHUP) &&
         ((of_terminal && gave_terminal_) || sigismember(&received_, number) == 1);
}

/// True if nobody reads the output of the child any more. Otherwise a controller or its thread wrote to a pipe of its
/// own.
bool Parent::lost_its_reader() const {
  return WIFSIGNALED(ended_) && WTERMSIG(ended_) == SIGPIPE && (notes->calls == 0 || is_reader_gone());
}

/// Recordings that are still open stay without their end: the child gave them up.
void Parent::leave(int status) {
  keeper_.drop_traces();
  _exit(status);
}

/// Ends in the same way as the child.
void Parent::mirror() {
  keeper_.drop_traces();
  end_as(ended_);
}

void Parent::find_line() {
  if (notes->deed[0] == '\0' || notes->library[0] == '\0' || damaged_) return;
  if (const auto line = source_line_at(text_of(notes->library), notes->address)) line_ = line->text();
}

std::string Parent::sentence() const {
  const std::string function = text_of(call_.function), controller = text_of(call_.controller);
  const std::string where = function == destroying ? at_the_end
                            : function == loading || function == unloading
                                ? fmt::format("while its library was {}", function)
                                : fmt::format("in {}() at tick {} ({} s)", function, call_.tick, call_.time);
  if (damaged_)
    return "a controller wrote over memory that it shares with its supervisor" +
           (controller.empty() ? "" : fmt::format("; the last known call: controller '{}' {}", controller, where));
  if (notes->deed[0] != '\0')
    return fmt::format("{}controller '{}' {} {}", line_, controller, text_of(notes->deed), where);
  if (hung_ || notes->hung == 1)
    return fmt::format("controller '{}' {} {}", controller, lateness(call_.limit, interrupted_), where);
  if (memory_limit_ > 0.0) {
    const bool in_call = notes->calls % 2 == 1;
    return fmt::format("{} took more than {:.0f} MB of memory{} {}",
                       in_call ? "controller '" + controller + "'" : "the process", memory_limit_ / 1e6,
                       in_call ? "" : ", after controller '" + controller + "' was called", where);
  }
  const std::string how = end_text(ended_);
  if (notes->calls % 2 == 1) return fmt::format("controller '{}' ended the process {} {}", controller, how, where);
  return fmt::format(
      "the process was ended {} after controller '{}' was called {}: by a thread, timer or limit that a controller "
      "set, by memory that it damaged, or from outside",
      how, controller, where);
}

/// Closes the recordings with all that the child has sent. Returns a line for each.
std::string Parent::close_traces() {
  std::string text;
  for (const std::string& line : keeper_.close_failed({text_of(call_.controller), sentence(), call_.tick, call_.time}))
    text += line + "\n";
  return text;
}

void announce(int status, void*) { announce_end(status); }

}  // namespace

void on_failed_process(std::function<void(const std::string&)> tell) { tell_failure = std::move(tell); }

void supervise_process() {
  const char* const wish = std::getenv("REHEARSE_SUPERVISE");
  if (wish && std::string_view(wish) == "off") return;
  if (notes || is_traced() || runs_under_valgrind()) return;  // under valgrind it would become two programs
  void* shared = mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  Ring* const ring = Ring::create();
  if (shared == MAP_FAILED || !ring) return;
  notes = new (shared) Notes;
  std::fflush(nullptr);
  // The program that started this one may ignore it: then the end of a child would not be reported.
  signal(SIGCHLD, SIG_DFL);
  sigset_t all, before;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, &before);
  const pid_t parent = getpid(), child = fork();
  if (child > 0) {
    setpgid(child, child);
    Parent(child, *ring).run();
  }
  if (child == 0) {
    setpgid(0, 0);
    send_recordings_through(*ring);
    note_streams(parent);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(controller_failed);
    on_exit(announce, nullptr);
    pthread_atfork(nullptr, nullptr, [] {
      if (!forks_run) notes = nullptr;  // other children of this process don't write into the notes
    });
  } else {
    notes = nullptr;  // fork failed: continue without a parent
  }
  sigprocmask(SIG_SETMASK, &before, nullptr);
}

void note_task(const char* name, int left) {
  if (!notes) return;
  put(notes->task, name);
  notes->tasks_left = left;
}

void note_call_begin(const char* controller, const char* function, std::int64_t tick, double time, double limit) {
  if (!notes) return;
  notes->deed[0] = '\0';
  const std::uint32_t next = (notes->latest + 1) % notes->last_calls.size();
  SealedCall& noted = notes->last_calls[next];
  NotedCall& call = noted.call;
  put(call.controller, controller);
  put(call.function, function);
  call.tick = tick;
  call.time = time;
  call.limit = limit;
  noted.seal = noted.right_seal();
  notes->latest = next;
  notes->calls.fetch_add(1, std::memory_order_release);
}

void note_call_end() {
  if (notes) notes->calls.fetch_add(1, std::memory_order_release);
}

void note_memory_limit(double bytes) {
  if (notes) notes->memory_limit = bytes;
}

void note_crash(const char* deed) {
  if (notes && notes->deed[0] == '\0') put(notes->deed, deed);
}

void note_crash_place(const void* place) {
  if (notes) note_place(place);
}

void fail_process(const char* deed, const void* place) {
  if (!notes) return;
  if (deed) note_crash(deed);
  notes->hung = deed ? 0 : 1;
  note_place(place);
  kill(getpid(), SIGKILL);
}

void fail_process_by_thread(const char* deed, const void* place) {
  if (!notes) return;
  put(notes->deed, "started a thread that ");
  const std::size_t length = std::strlen(notes->deed);
  std::strncpy(notes->deed + length, deed, sizeof notes->deed - length - 1);
  note_place(place);
  kill(getpid(), SIGKILL);
}

/// In a call it is the controller, or a thread of its own, that ends the process.
void announce_end(int status) {
  if (!notes || notes->calls % 2 == 1 || in_controllers_code()) return;
  notes->status = status;
  notes->checks_leaks = checks_leaks() ? 1 : 0;
  notes->announced = regular_end;
}

bool is_supervised() { return notes != nullptr; }

pid_t fork_run() {
  std::fflush(nullptr);  // or both would print it
  const pid_t here = getpid();
  forks_run = true;
  share_recordings_with_forks(true);
  const pid_t run = fork();
  const int reason = errno;
  share_recordings_with_forks(false);
  forks_run = false;
  if (run == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != here) leave_process(controller_failed);
    watch_calls_after_fork();
  }
  present_run = std::max(run, 0);
  if (notes && run > 0) notes->run = run;
  errno = reason;
  return run;
}

int end_of_run(pid_t run) {
  int ended = 0;
  while (waitpid(run, &ended, 0) < 0 && errno == EINTR) continue;
  present_run = 0;
  if (notes) notes->run = 0;
  return ended;
}

void note_result_of_run(int ended) {
  if (!notes || notes->calls % 2 == 0) return;
  const bool is_told =
      notes->hung.exchange(0) == 1 || (WIFEXITED(ended) && (checks_leaks() || WEXITSTATUS(ended) == 0));
  const NotedCall call = notes->last_calls[notes->latest % notes->last_calls.size()].call;
  if (!is_told && call.function == std::string_view(destroying))
    fmt::print(stderr, "warning: controller '{}' ended the process {} {}\n", text_of(call.controller), end_text(ended),
               at_the_end);
  note_call_end();
}

bool is_own_run(pid_t process) { return present_run != 0 && process == present_run; }

void end_as(int ended) {
  if (WIFEXITED(ended)) leave_process(WEXITSTATUS(ended));
  const int number = WTERMSIG(ended);
  const rlimit no_core{};
  setrlimit(RLIMIT_CORE, &no_core);
  signal(number, SIG_DFL);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, number);
  sigprocmask(SIG_UNBLOCK, &one, nullptr);
  raise(number);
  leave_process(128 + number);
}

}  // namespace rehearse
