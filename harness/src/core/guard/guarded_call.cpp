#include "guarded_call.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gnu/lib-names.h>
#include <link.h>
#include <pthread.h>
#include <rehearse/diagnostic.h>
#include <setjmp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string_view>
#include <vector>

#include "c_library.h"
#include "core/turns/raw_call.h"
#include "exception_text.h"
#include "guest_frame.h"
#include "interruption.h"
#include "process_end.h"
#include "process_guard.h"
#include "source_line.h"
#include "supervise.h"
#include "supervisor.h"
#include "turn_calls.h"
#include "watchdog.h"

namespace rehearse {
namespace {

constexpr int caught_signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
/// These signals end a process, too. A controller may handle them itself.
constexpr int deadly_signals[] = {SIGALRM, SIGVTALRM, SIGPROF, SIGXFSZ, SIGSYS};
constexpr int exit_instead = -1;    // value at the return point for an exit, instead of a signal
constexpr int stack_overflow = -2;  // the same for SIGSEGV or SIGBUS below the end of a stack
constexpr int damaged_heap = -3;    // the same for an abort by the C library itself
constexpr int abort_by_deed = -4;   // the same for an abort whose cause is known
constexpr int deadlock = -5;        // the same if all threads that take turns wait for each other
constexpr std::size_t signal_stack_size = 64 * 1024;
constexpr std::size_t stack_gap = 16 * 1024;

sigjmp_buf return_point;
volatile sig_atomic_t guarding = 0;
pthread_t guarded_thread;
const char* last_deed = nullptr;    // how the code of the last call ended it, or tried to end the process
const void* crash_place = nullptr;  // of the last call
std::terminate_handler outside_terminate = nullptr;
struct sigaction outside_actions[NSIG];  // the actions before those of this file

/// A page that contains 1 during guarded calls, and zeros in a process that is forked in one, where the kernel wipes
/// it. So the end of a call in such a process is detected without a system call.
volatile unsigned char* const unforked = [] {
  constexpr std::size_t size = 4096;
  void* page = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) return static_cast<unsigned char*>(calloc(size, 1));
  madvise(page, size, MADV_WIPEONFORK);
  return static_cast<unsigned char*>(page);
}();

/// The failure of a thread that a controller started.
struct ThreadFailure {
  std::atomic<int> state{0};  // 0: none; 1: it is being written; 2: it can be read
  const void* library = nullptr;
  const void* place = nullptr;  // null: it isn't known
  bool has_hung = false;        // its turn exceeded the limit of the call
  char deed[512] = {};
} thread_failure;

/// What the threads of the last deadlock wait for.
std::vector<TurnScheduler::Waiting>& stuck_threads = *new std::vector<TurnScheduler::Waiting>;

volatile sig_atomic_t dies_in_library = 0;  // see end_process_at_library_crashes()

/// The lowest addresses of this thread's stack and of its signal stack; null: not known.
thread_local constinit const char* stack_bottom = nullptr;
thread_local constinit const char* signal_stack_bottom = nullptr;

/// The interrupted code's stack pointer; null: not known on this processor.
const char* stack_pointer(const ucontext_t& interrupted) {
#if defined(__x86_64__)
  return reinterpret_cast<const char*>(interrupted.uc_mcontext.gregs[REG_RSP]);
#elif defined(__aarch64__)
  return reinterpret_cast<const char*>(interrupted.uc_mcontext.sp);
#else
  static_cast<void>(interrupted);
  return nullptr;
#endif
}

/// True if the fault is an access below the end of this thread's stack, at or above its stack pointer, which has
/// reached that end. A fault by a wild pointer happens while the stack pointer is inside of the stack.
bool is_stack_overflow(const siginfo_t& fault, const ucontext_t& interrupted) {
  constexpr std::uintptr_t margin = 64 * 1024, page = 4096, largest_frame = 1 << 30;  // [bytes]
  const auto number = [](const void* address) { return reinterpret_cast<std::uintptr_t>(address); };
  const std::uintptr_t bottom = number(stack_bottom), pointer = number(stack_pointer(interrupted));
  const std::uintptr_t address = number(fault.si_addr), handlers = number(signal_stack_bottom);
  if (fault.si_code <= 0 || bottom == 0 || pointer == 0) return false;
  if (pointer >= handlers && pointer - handlers < signal_stack_size) return false;  // in a handler, on its own stack
  return pointer < bottom + margin && pointer + largest_frame > bottom && address < bottom + page &&
         address + margin > pointer;
}

/// The interrupted code's place; null: not known on this processor.
const void* program_counter(const ucontext_t& interrupted) {
#if defined(__x86_64__)
  return reinterpret_cast<const void*>(interrupted.uc_mcontext.gregs[REG_RIP]);
#elif defined(__aarch64__)
  return reinterpret_cast<const void*>(interrupted.uc_mcontext.pc);
#else
  static_cast<void>(interrupted);
  return nullptr;
#endif
}

/// The code of the C library and of the dynamic linker. An interrupted function of them may hold a lock that this
/// process needs, as that of the heap.
struct LibraryCode {
  std::uintptr_t begin = 0, end = 0;
};
std::array<LibraryCode, 4> library_code;

void find_library_code() {
  std::size_t count = 0;
  dl_iterate_phdr(
      [](dl_phdr_info* object, std::size_t, void* found) {
        const std::string_view name = object->dlpi_name ? object->dlpi_name : "";
        const bool is_library =
            name.ends_with("/" LIBC_SO) || name.ends_with("/" LD_SO) || name.find("libclang_rt.asan") != name.npos;
        for (int i = 0; is_library && i < object->dlpi_phnum; ++i) {
          const ElfW(Phdr)& segment = object->dlpi_phdr[i];
          if (segment.p_type != PT_LOAD || !(segment.p_flags & PF_X)) continue;
          std::size_t& next = *static_cast<std::size_t*>(found);
          if (next == library_code.size()) return 1;
          const std::uintptr_t begin = object->dlpi_addr + segment.p_vaddr;
          library_code[next++] = {begin, begin + segment.p_memsz};
        }
        return 0;
      },
      &count);
}

bool is_in_library(const ucontext_t& interrupted) {
  const auto place = reinterpret_cast<std::uintptr_t>(program_counter(interrupted));
  return std::ranges::any_of(library_code,
                             [place](const LibraryCode& code) { return place >= code.begin && place < code.end; });
}

/// Also called in a signal handler.
const char* describe_signal(int signal_number) {
  switch (signal_number) {
    case stack_overflow:
      return "crashed: its stack overflowed (a recursion without end, or local variables that are too large)";
    case SIGSEGV:
      return "crashed: segmentation fault (an access to memory that isn't there, as through a null pointer)";
    case SIGBUS: return "crashed: bus error";
    case SIGFPE: return "crashed: arithmetic fault (as a division of an integer by zero)";
    case SIGILL: return "crashed: illegal instruction";
    case SIGABRT: return "crashed: it called abort, or an assertion of its own failed";
    case damaged_heap:
      return "crashed: the C library found damaged memory (a write beyond an allocation, or a second free)";
    case SIGALRM: return "was ended by SIGALRM, of a timer that nobody handles (alarm or setitimer)";
    case SIGVTALRM: return "was ended by SIGVTALRM, of a timer that nobody handles (setitimer)";
    case SIGPROF: return "was ended by SIGPROF, of a timer that nobody handles (setitimer)";
    case SIGXFSZ: return "was ended by SIGXFSZ: a file grew beyond the limit of the process";
    case SIGSYS: return "was ended by SIGSYS: a system call that it may not make";
    default: return "was ended by a signal that nobody handles";
  }
}

bool is_fault(int signal_number) {
  return signal_number == SIGSEGV || signal_number == SIGBUS || signal_number == SIGFPE || signal_number == SIGILL;
}

/// The deed of a thread that takes turns and kept its turn until the limit of the call.
constexpr const char* hung_turn =
    "neither waited nor ended within the limit of the call, so no other thread had a turn (threads: free lets it run "
    "beside the others)";

/// True if the call is late because another thread has the turn.
bool hangs_in_other_thread(int signal_number) {
  return signal_number == hang_signal && in_guarded_call() && thread_failure.state == 0 &&
         TurnScheduler::instance().other_at_turn() != nullptr;
}

/// True if this thread of a controller has the turn, and the call is late.
bool hangs_at_turn(int signal_number) {
  return signal_number == hang_signal && own_threads && this_turn && !is_forked_by_guest() &&
         TurnScheduler::instance().other_at_turn() == this_turn;
}

/// Gives the signal to the thread that has the turn.
void pass_hang_on() {
  if (const TurnThread* const other = TurnScheduler::instance().other_at_turn(); other && other->tid != 0)
    raw_call(SYS_tgkill, raw_call(SYS_getpid), other->tid, hang_signal);
}

extern "C" void leave_guarded_code(int signal_number, siginfo_t* fault, void* interrupted) {
  end_walk_of_frames();
  const bool overflowed = (signal_number == SIGSEGV || signal_number == SIGBUS) &&
                          is_stack_overflow(*fault, *static_cast<const ucontext_t*>(interrupted));
  if (hangs_in_other_thread(signal_number)) return pass_hang_on();
  const bool in_library = is_in_library(*static_cast<const ucontext_t*>(interrupted));
  const int reason = overflowed                               ? stack_overflow
                     : in_library && signal_number == SIGABRT ? damaged_heap
                                                              : signal_number;
  end_if_ending(signal_number == hang_signal ? nullptr : describe_signal(reason));
  // First of all, because everything below reads memory that the controller may have damaged.
  if (in_guarded_call() && signal_number != hang_signal) note_crash(describe_signal(reason));
  const bool hangs_here = hangs_at_turn(signal_number);
  const void* place =
      is_fault(signal_number) || hangs_here ? program_counter(*static_cast<const ucontext_t*>(interrupted)) : nullptr;
  if (place && !overflowed && in_controllers_code()) place = guest_frame_of(place);
  if (in_library && !is_forked_by_guest()) {
    // The process can't go on: its next call of the function may wait for ever. Its parent reports the failure.
    if (in_guarded_call() && thread_failure.state == 2)
      fail_process_by_thread(thread_failure.deed, thread_failure.place);
    if (in_guarded_call()) fail_process(signal_number == hang_signal ? nullptr : describe_signal(reason), place);
    if (own_threads && hangs_here) fail_process_by_thread(hung_turn, place);
    if (own_threads && signal_number != hang_signal) fail_process_by_thread(describe_signal(reason), place);
    if (in_guarded_call() && dies_in_library && signal_number != hang_signal) leave_process(128 + signal_number);
  }
  if (in_guarded_call()) {
    if (signal_number != hang_signal) note_crash_place(place);
    this_turn = nullptr;  // its record may be damaged, and end_call() ends the turn
    crash_place = place;
    guarding = 0;
    siglongjmp(return_point, reason);
  }
  if (hangs_here) {
    thread_failure.has_hung = true;
    fail_on_own_thread(hung_turn, place);
  }
  if (signal_number == hang_signal) return;  // it came too late: the call has returned
  if (own_threads && !is_forked_by_guest()) fail_on_own_thread(describe_signal(reason), place);
  // The host doesn't hide crashes outside of guarded code: the previous handler gets the signal when the fault repeats.
  sigaction(signal_number, &outside_actions[signal_number], nullptr);
  if (!is_fault(signal_number)) raise(signal_number);
}

/// The signal stack of the thread that makes the calls. It exists as long as the process, because exit() destroys a
/// thread's own objects first.
void provide_signal_stack() {
  thread_local SignalStack* stack = nullptr;
  if (!stack) stack = new SignalStack;
}

/// Ends a controller's code that threw where nothing may be thrown. The C++ library's own handler would print the
/// exception's text as it is.
[[noreturn]] void end_after_terminate() {
  if ((in_controllers_code() || is_process_ending()) && !is_forked_by_guest()) {
    static thread_local char deed[512];
    std::snprintf(deed, sizeof deed, "%s", describe_termination().c_str());
    abort_controllers_code(deed);
  }
  if (outside_terminate) outside_terminate();
  std::abort();
}

void install_handlers() {
  static bool installed = false;
  if (installed) return;
  installed = true;
  find_library_code();
  prepare_guest_frames();
  outside_terminate = std::set_terminate(end_after_terminate);
  struct sigaction action {};
  action.sa_sigaction = leave_guarded_code;
  // SA_NODEFER: the signal isn't blocked after siglongjmp leaves the handler.
  action.sa_flags = SA_ONSTACK | SA_NODEFER | SA_SIGINFO;
  for (const int signal_number : caught_signals) sigaction(signal_number, &action, &outside_actions[signal_number]);
  sigaction(hang_signal, &action, &outside_actions[hang_signal]);
  for (const int signal_number : deadly_signals) {
    sigaction(signal_number, nullptr, &outside_actions[signal_number]);
    if (outside_actions[signal_number].sa_handler == SIG_DFL) sigaction(signal_number, &action, nullptr);
  }
}

/// In a call the replacements of the C library's functions change no limits.
void restore_limits_in_call() {
  guarding = 0;
  ProcessGuard::instance().restore_limits();
  guarding = 1;
}

/// The name of a function that a library of a controller exports; else empty.
std::string name_of_guests_function(const void* function) {
  Dl_info found{};
  if (!is_code_of_guest(function) || dladdr(function, &found) == 0 || !found.dli_sname) return "";
  return found.dli_saddr == function ? found.dli_sname : "";
}

/// Runs the code and catches its exceptions.
void run_catching(const std::function<void()>& code, CallOutcome& outcome) {
  try {
    code();
  } catch (...) {
    restore_limits_in_call();
    outcome.end = CallEnd::threw;
    outcome.what = describe_exception();
  }
}

}  // namespace

void prepare_guarded_calls() {
  install_handlers();
  provide_signal_stack();
  prepare_turns();
}

void watch_calls_after_fork() { Watchdog::forget(); }

void end_process_at_library_crashes() { dies_in_library = 1; }

void guard_rest_of_process(double limit) {
  guarded_thread = pthread_self();
  provide_signal_stack();
  Watchdog::instance().begin(guarded_thread, limit);
}

/// Leaves a gap in the stack above it, so that an array overrun reaches the gap instead of the host's frames.
[[gnu::noinline]] void run_below_gap(const std::function<void()>& code, CallOutcome& outcome) {
  char* const gap = static_cast<char*>(__builtin_alloca(stack_gap));
  asm volatile("" : : "r"(gap) : "memory");
  run_catching(code, outcome);
  asm volatile("" : : "r"(gap) : "memory");
}

/// Reads the failure of a controller's thread since the last call.
void take_thread_failure(CallOutcome& outcome) {
  if (thread_failure.state.load(std::memory_order_acquire) != 2) return;
  outcome.end = thread_failure.has_hung ? CallEnd::hung : CallEnd::crashed;
  thread_failure.has_hung = false;
  outcome.what = fmt::format("started a thread that {}", thread_failure.deed);
  outcome.by_thread_of = thread_failure.library;
  outcome.place = thread_failure.place;
  thread_failure.state.store(0, std::memory_order_release);
}

CallOutcome guarded_call(const std::function<void()>& code, double limit) {
  REHEARSE_ASSERT(!guarding, "guarded calls don't nest");
  prepare_guarded_calls();
  guarded_thread = pthread_self();
  *unforked = 1;
  const FloatMode standard, mode_before = float_mode();
  if (!(mode_before == standard)) set_float_mode(standard);
  CallOutcome outcome;
  crash_place = nullptr;
  Watchdog::instance().begin(guarded_thread, limit);
  const int signal_number = sigsetjmp(return_point, 0);
  if (signal_number == 0) {
    guarding = 1;
    TurnScheduler::instance().begin_call(ProcessGuard::instance().threads_of_call());
    run_below_gap(code, outcome);
    guarding = 0;
  } else {
    ProcessGuard::instance().restore_limits();
    outcome.end = signal_number == exit_instead  ? CallEnd::exited
                  : signal_number == hang_signal ? CallEnd::hung
                  : signal_number == deadlock    ? CallEnd::hung
                                                 : CallEnd::crashed;
  }
  TurnScheduler::instance().end_call(outcome.end != CallEnd::returned && outcome.end != CallEnd::threw);
  if (signal_number == deadlock) outcome.what = describe_deadlock();
  if (*unforked == 0) leave_process(EXIT_FAILURE);  // a child that the code forked: the run belongs to its parent
  Watchdog::instance().end();
  outcome.float_mode = float_mode();
  outcome.changed_float_mode = !(outcome.float_mode == standard);
  if (!(outcome.float_mode == mode_before)) set_float_mode(mode_before);
  if (outcome.end == CallEnd::hung && signal_number != deadlock)
    outcome.what = lateness(limit, interruption());
  else if (outcome.end == CallEnd::exited || signal_number == abort_by_deed)
    outcome.what = last_deed;
  else if (outcome.end == CallEnd::crashed)
    outcome.what = describe_signal(signal_number);
  if (outcome.end == CallEnd::crashed) outcome.place = crash_place;
  take_thread_failure(outcome);
  return outcome;
}

bool in_guarded_call() { return guarding && *unforked && pthread_equal(pthread_self(), guarded_thread); }

bool is_forked_by_guest() {
  return unforked && *unforked == 0 && (own_threads || (guarding && pthread_equal(pthread_self(), guarded_thread)));
}

bool in_controllers_code() { return in_guarded_call() || own_threads; }

void fail_on_own_thread(const char* deed, const void* place) {
  int none = 0;
  if (thread_failure.state.compare_exchange_strong(none, 1)) {
    std::strncpy(thread_failure.deed, deed, sizeof thread_failure.deed - 1);
    thread_failure.place = place;
    thread_failure.library = own_threads ? own_threads->get() : nullptr;
    thread_failure.state.store(2, std::memory_order_release);
    if (guarding) pthread_kill(guarded_thread, hang_signal);
  }
  for (;;) pause();
}

bool is_traced(const char* status_file) {
  const int status = open(status_file, O_RDONLY | O_CLOEXEC);
  if (status < 0) return false;
  char text[4096] = {};
  const ssize_t size = read(status, text, sizeof text - 1);
  close(status);
  constexpr const char* key = "\nTracerPid:\t";
  const char* tracer = size > 0 ? std::strstr(text, key) : nullptr;
  return tracer && tracer[std::strlen(key)] != '0';
}

SignalStack::SignalStack() : memory_(new char[signal_stack_size]) {
  pthread_attr_t own;
  if (pthread_getattr_np(pthread_self(), &own) == 0) {
    void* bottom = nullptr;
    std::size_t size = 0;
    if (pthread_attr_getstack(&own, &bottom, &size) == 0) stack_bottom = static_cast<const char*>(bottom);
    pthread_attr_destroy(&own);
  }
  signal_stack_bottom = memory_;
  stack_t alternate{};
  alternate.ss_sp = memory_;
  alternate.ss_size = signal_stack_size;
  sigaltstack(&alternate, nullptr);
}

SignalStack::~SignalStack() {
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  sigaltstack(&none, nullptr);
  signal_stack_bottom = nullptr;
  delete[] memory_;
}

bool ends_calls(int signal_number) {
  return signal_number == hang_signal || std::ranges::find(caught_signals, signal_number) != std::end(caught_signals);
}

void abort_controllers_code(const char* deed) {
  const char* const what = deed ? deed : describe_signal(SIGABRT);
  end_if_ending(what);
  if (!in_guarded_call()) fail_on_own_thread(what);
  last_deed = what;
  guarding = 0;
  siglongjmp(return_point, abort_by_deed);
}

void prepare_turns() {
  TurnScheduler& turns = TurnScheduler::instance();
  turns.find_places = guest_frames;
  turns.name_of_function = name_of_guests_function;
  turns.on_deadlock = [] {
    if (!in_guarded_call()) return end_if_ending("waits for threads that wait for each other");
    stuck_threads = TurnScheduler::instance().stuck();
    guarding = 0;
    siglongjmp(return_point, deadlock);
  };
}

static std::string sentence_of(const TurnScheduler::Waiting& waiting) {
  const auto line = source_line_of(waiting.places);
  return fmt::format("{}{} waits for {}", line ? line->text() : "", waiting.thread, waiting.waits_for);
}

std::string describe_deadlock() {
  std::string text = "never goes on, because its threads wait for each other";
  for (const TurnScheduler::Waiting& waiting : stuck_threads) text += "; " + sentence_of(waiting);
  return text;
}

std::vector<std::string> describe_threads_at_rest() {
  std::vector<std::string> all;
  for (const TurnScheduler::Waiting& waiting : TurnScheduler::instance().at_rest()) all.push_back(sentence_of(waiting));
  return all;
}

void leave_guarded_call(const char* deed) {
  REHEARSE_ASSERT(in_guarded_call(), "there is a call to leave");
  last_deed = deed;
  guarding = 0;
  siglongjmp(return_point, exit_instead);
}

}  // namespace rehearse
