#include "supervisor.h"

#include <fmt/format.h>
#include <pthread.h>
#include <rehearse/pin.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

#include "guarded_call.h"
#include "interruption.h"
#include "mcap/recover.h"
#include "supervise.h"

namespace rehearse {
namespace {

constexpr int controller_failed = 3;  // the exit status
constexpr double patience = 5.0;      // time for a child to report a call that took too long [s]
constexpr timespec silence{1, 0};     // after which a silent child is checked

/// Memory that parent and child share. The child writes, and may be killed at any time.
struct Notes {
  std::atomic<std::uint64_t> calls{0};  // number of begins and ends; odd: a call is running
  std::atomic<bool> announced{false};
  std::atomic<bool> recording{false};  // `file` is being written
  int status = 0;                      // the announced exit status
  std::int64_t tick = 0;
  double time = 0.0;   // [s] of simulation
  double limit = 0.0;  // [s]
  int tasks_left = 0;
  char controller[256] = {};
  char function[64] = {};
  char task[512] = {};
  char file[4096] = {};
};

Notes* notes = nullptr;  // null: this process has no supervisor

template <std::size_t size>
void put(char (&place)[size], const char* text) {
  const std::size_t length = strnlen(text, size - 1);
  std::memcpy(place, text, length);
  place[length] = '\0';
}

/// The waiting parent.
class Parent {
 public:
  explicit Parent(pid_t child) : child_(child) {}
  [[noreturn]] void run();

 private:
  bool has_ended();
  void pass_on(const siginfo_t& signal);
  void look_for_hang();
  bool was_interrupted() const;
  bool lost_its_reader() const;
  [[noreturn]] void mirror() const;
  std::string sentence() const;
  std::string saved() const;

  const pid_t child_;
  int ended_ = 0;        // as returned by waitpid()
  sigset_t received_{};  // signals from outside
  std::uint64_t calls_ = 0;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  bool hung_ = false;
};

void Parent::run() {
  // Signals that stop a job keep their actions: a shell waits until this process has stopped, too.
  sigset_t all;
  sigfillset(&all);
  for (const int number : {SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT}) sigdelset(&all, number);
  sigemptyset(&received_);
  while (!has_ended()) {
    siginfo_t signal{};
    const int number = sigtimedwait(&all, &signal, &silence);
    if (number > 0 && number != SIGCHLD) pass_on(signal);
    if (number < 0 && errno == EAGAIN) look_for_hang();
  }
  for (siginfo_t signal{}; sigtimedwait(&all, &signal, std::array<timespec, 1>{}.data()) > 0;)
    sigaddset(&received_, signal.si_signo);
  if (lost_its_reader()) {
    if (notes->recording) static_cast<void>(saved());
    mirror();
  }
  const bool announced = notes->announced;
  if (announced && WIFEXITED(ended_)) _exit(WEXITSTATUS(ended_) != 0 ? WEXITSTATUS(ended_) : notes->status);
  if (announced) _exit(notes->status != 0 ? notes->status : controller_failed);
  if (notes->calls == 0 || was_interrupted()) mirror();
  std::string text = "error: " + sentence() + "\n";
  if (notes->task[0] != '\0')
    text += fmt::format("error: it was in {}; {} not run\n", notes->task,
                        notes->tasks_left == 1 ? "1 after it was" : fmt::format("{} after it were", notes->tasks_left));
  if (notes->recording) text += saved() + "\n";
  std::fputs(text.c_str(), stderr);
  _exit(controller_failed);
}

bool Parent::has_ended() {
  pid_t ended = 0;
  do ended = waitpid(child_, &ended_, WNOHANG);
  while (ended < 0 && errno == EINTR);
  return ended == child_ || ended < 0;
}

/// A terminal signals all of its foreground processes, the child among them; only a signal to this process alone is
/// passed on.
void Parent::pass_on(const siginfo_t& signal) {
  sigaddset(&received_, signal.si_signo);
  const bool from_outside = signal.si_code <= 0 && signal.si_pid != child_;
  if (from_outside) kill(child_, signal.si_signo);
}

/// Kills a child with a hanging call. The child reports such a call itself, unless its controller disabled the signal
/// for that, or holds a lock that the report needs.
void Parent::look_for_hang() {
  const std::uint64_t calls = notes->calls;
  const auto now = std::chrono::steady_clock::now();
  if (calls != calls_ || calls % 2 == 0) {
    calls_ = calls;
    since_ = now;
  }
  const double silent = std::chrono::duration<double>(now - since_).count();
  if (silent < 2.0 * notes->limit + patience || is_traced(fmt::format("/proc/{}/status", child_).c_str())) return;
  hung_ = true;
  kill(child_, SIGKILL);
}

/// True if both processes were interrupted by the same sender.
bool Parent::was_interrupted() const {
  if (!WIFSIGNALED(ended_)) return false;
  const int number = WTERMSIG(ended_);
  return (number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGQUIT) &&
         sigismember(&received_, number) == 1;
}

/// True if nobody reads the output of the child any more. Otherwise a controller or its thread wrote to a pipe of its
/// own.
bool Parent::lost_its_reader() const {
  return WIFSIGNALED(ended_) && WTERMSIG(ended_) == SIGPIPE && (notes->calls == 0 || is_reader_gone());
}

/// Ends in the same way as the child.
void Parent::mirror() const {
  if (WIFEXITED(ended_)) _exit(WEXITSTATUS(ended_));
  const int number = WTERMSIG(ended_);
  const rlimit no_core{};
  setrlimit(RLIMIT_CORE, &no_core);
  signal(number, SIG_DFL);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, number);
  sigprocmask(SIG_UNBLOCK, &one, nullptr);
  raise(number);
  _exit(128 + number);
}

std::string Parent::sentence() const {
  const std::string function = notes->function;
  const std::string where = function == loading || function == unloading
                                ? fmt::format("while its library was {}", function)
                                : fmt::format("in {}() at tick {} ({} s)", function, notes->tick, notes->time);
  if (hung_)
    return fmt::format("controller '{}' did not return within {} s {}, and its process had to be killed",
                       notes->controller, notes->limit, where);
  const std::string how = WIFEXITED(ended_) ? fmt::format("with exit status {}", WEXITSTATUS(ended_))
                                            : fmt::format("by SIG{}", sigabbrev_np(WTERMSIG(ended_)));
  if (notes->calls % 2 == 1)
    return fmt::format("controller '{}' ended the process {} {}", notes->controller, how, where);
  return fmt::format(
      "the process was ended {} after controller '{}' was called {}: by a thread, timer or limit that a controller "
      "set, by memory that it damaged, or from outside",
      how, notes->controller, where);
}

/// Recovers the recording as far as it was written.
std::string Parent::saved() const {
  const std::filesystem::path file = notes->file, saved = file.string() + ".saved";
  const auto recovery = mcap::recover(file, saved);
  std::error_code failed;
  if (recovery) std::filesystem::rename(saved, file, failed);
  if (!recovery || failed) return fmt::format("nothing of the trace {} can be saved", file.string());
  return fmt::format("the trace, as far as it was written, to {:g} s: {}",
                     static_cast<double>(recovery->last_time) / 1e9, file.string());
}

void announce(int status, void*) { announce_end(status); }

}  // namespace

void supervise_process() {
  if (notes || is_traced() || runs_under_valgrind()) return;  // under valgrind it would become two programs
  void* shared = mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return;
  notes = new (shared) Notes;
  std::fflush(nullptr);
  // The program that started this one may ignore it: then the end of a child would not be reported.
  signal(SIGCHLD, SIG_DFL);
  sigset_t all, before;
  sigfillset(&all);
  for (const int number : {SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT}) sigdelset(&all, number);
  sigprocmask(SIG_BLOCK, &all, &before);
  const pid_t parent = getpid(), child = fork();
  if (child > 0) Parent(child).run();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(controller_failed);
    on_exit(announce, nullptr);
    pthread_atfork(nullptr, nullptr, [] { notes = nullptr; });  // children of this process don't write into the notes
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
  put(notes->controller, controller);
  put(notes->function, function);
  notes->tick = tick;
  notes->time = time;
  notes->limit = limit;
  notes->calls.fetch_add(1, std::memory_order_release);
}

void note_call_end() {
  if (notes) notes->calls.fetch_add(1, std::memory_order_release);
}

void note_recording(const std::filesystem::path& file) {
  if (!notes) return;
  notes->recording = false;
  std::error_code ignored;
  put(notes->file, std::filesystem::absolute(file, ignored).c_str());
  notes->recording = !file.empty();
}

/// In a call it is the controller, or a thread of its own, that ends the process.
void announce_end(int status) {
  if (!notes || notes->calls % 2 == 1 || in_controllers_code()) return;
  notes->status = status;
  notes->announced = true;
}

}  // namespace rehearse
