// TurnScheduler: the threads of controllers take turns, so that their order is a function of the program.
//
// At most one thread runs. It goes on until it waits, yields or ends; then the thread that was woken first runs. The
// thread that makes the guarded calls is one of them while a call runs, "the caller" below. Time is that of the
// simulation, and the same for all threads. After a call the caller lets the others run until all wait. If the caller
// itself waits for the others, and all of them wait for a time, simulated time goes on to the earliest of these times.
//
// Each thread is blocked on its own futex by a system call past the C library, whose functions are replaced
// (guard/turn_functions.h). Only the thread whose turn it is reads or writes the scheduler's data.
#pragma once

#include <pthread.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "turn_order.h"

namespace rehearse {

/// The version of the order in which threads run. It is part of the key of a proof.
inline constexpr int rules_of_turns = 1;

/// Libraries of OpenMP, whose threads wait past the C library, so that they can't take turns.
inline constexpr const char* libraries_without_turns[] = {"libgomp.so", "libomp.so", "libiomp5.so"};

/// Places in the code of guests, the innermost call first; null behind the last one.
using CodePlaces = std::array<const void*, 6>;

/// The threads that the code of one library has started, and the rules for them.
struct GuestThreads {
  std::atomic<int> running{0};
  std::atomic<int> in_turns{0};  // threads that were started under turns
  bool are_free = false;         // they run as the kernel lets them
  bool from_start = false;       // the library can start threads: its clocks are simulated before it does
  /// By the name of a thread, or of the function with which it begins: how much later it goes on when it was woken
  /// [ns].
  std::map<std::string, std::int64_t, std::less<>> delays;
  std::set<std::string, std::less<>> met;  // the names and functions that were looked for in `delays`
  /// Waits for something outside of the process: words and places, each once.
  std::vector<std::pair<const char*, CodePlaces>> outside;
  const char* free_because = nullptr;  // the library whose threads can't take turns; null: there was none
};

using ThreadCount = std::shared_ptr<GuestThreads>;

/// What a thread waits for.
struct TurnWait {
  const char* words = "";        // "a mutex"
  const void* object = nullptr;  // its address; null: nothing can end the wait but time
  const int* owner = nullptr;    // the kernel's number of the thread that has the object; null: none has it
  std::uint32_t mask = ~0u;      // of a futex
  bool is_short = false;         // as for a mutex: a delay of the thread isn't added
};

struct TurnThread {
  enum class State : std::uint8_t { running, ready, waiting, resting, outside, suspended, ended };
  static constexpr std::int64_t never = INT64_MAX;

  static constexpr std::uint32_t may_run = 1, must_state_place = 2;
  std::atomic<std::uint32_t> go{0};  // one of these, or 0: it waits
  std::atomic<std::uint32_t> has_place{0};
  std::atomic<bool> is_lost{false};  // its call failed: it never runs again
  State state = State::ready;
  bool timed_out = false;
  bool is_delayed = false;   // it was woken, and waits for its delay
  bool was_delayed = false;  // its delay has passed
  bool is_detached = false, is_cancelled = false;
  bool is_alone = false;  // the caller, while there is no other thread: it really waits
  TurnWait wait{"its start", nullptr};
  std::int64_t deadline = never;  // of its wait [ns]
  std::int64_t woken_at = 0;      // [ns]
  int idle = 0;                   // reads of clocks and yields since its last wait
  long tid = 0;
  long after = 0;  // the thread that had the turn before, and has ended: this one begins when it is gone; 0: none
  int number = 0;  // 1, 2, ...: in the order of their start; 0: the caller
  char name[16] = "";
  CodePlaces places{};             // where it waits
  const void* function = nullptr;  // with which it begins
  pthread_t handle{};
  ThreadCount guest;  // null: the caller between its calls
  TurnThread* next_arrived = nullptr;
};

/// The record of this thread if it takes turns; else null.
extern thread_local constinit TurnThread* this_turn __attribute__((tls_model("initial-exec")));

class TurnScheduler {
 public:
  using State = TurnThread::State;
  static constexpr std::int64_t never = TurnThread::never;
  /// A thread that reads clocks this often without waiting, or yields so often times reads_of_a_yield, has to wait.
  static constexpr int most_reads = 1000;
  static constexpr int reads_of_a_yield = 50;
  static constexpr std::int64_t idle_wait = 100'000;                     // [ns]
  static constexpr std::int64_t start_date = 1'767'225'600'000'000'000;  // [ns] since 1970: 2026-01-01 UTC
  static constexpr std::int64_t start_uptime = 1'000'000'000'000;        // [ns]

  /// The only one of the process.
  static TurnScheduler& instance();

  // Called by the host, outside of calls.

  /// A run begins: if no thread is left of an earlier one, its time begins at 0.
  void begin_run();
  /// The simulated time of the next calls [ns]. It never goes back.
  void set_time(std::int64_t nanoseconds);
  /// The number of threads of this guest that take turns.
  int count_of(const GuestThreads& guest) const;

  // Called by the guarded call.

  /// The caller takes part, if there are threads under turns, or the guest can start some.
  void begin_call(const ThreadCount& guest);
  /// The caller takes part until the process ends, if there are threads under turns: destructors may wait for them.
  void begin_end_of_process();
  /// The caller takes no part any more. `failed`: no thread of the guest runs again.
  void end_call(bool failed);
  /// Lets the others run until all wait. `until`: simulated time goes on to this time [ns]; 0: it stands still.
  void let_others_run(std::int64_t until = 0);
  /// The thread whose turn it is, if it isn't the caller; else null. May be called in a signal handler.
  const TurnThread* other_at_turn() const;

  // Called by threads that take turns, and by the caller.

  /// The caller takes turns from now on: its guest starts a thread.
  void join_in(const ThreadCount& guest);
  /// A new thread, which doesn't exist yet. `function`: with which it begins.
  TurnThread* add(const ThreadCount& guest, const void* function);
  /// The new thread exists, or couldn't be started.
  void started(TurnThread& thread, pthread_t handle, bool is_detached);
  void forget(TurnThread& thread);
  /// The first call of a new thread: waits for its turn.
  void begin_thread(TurnThread& thread);
  /// The last one.
  void end_thread();

  std::int64_t now() const { return now_; }
  /// A read of a clock, which counts as such.
  std::int64_t read_time();
  /// Waits until woken. False: the deadline came first [ns].
  bool wait(const TurnWait& wait, std::int64_t deadline = never);
  /// Wakes up to `count` threads that wait for the object, in the order of their waiting. Returns their number.
  int wake(const void* object, int count, std::uint32_t mask = ~0u);
  /// The others that wait for one object wait for another one from now on.
  int requeue(const void* from, const void* to, int count);
  /// True if a thread was woken for the object and hasn't run since.
  bool is_promised(const void* object) const;
  void yield();
  void sleep_until(std::int64_t deadline);
  /// This thread never runs again, but keeps what it has.
  [[noreturn]] void stop_for_good(const char* why);
  /// Doesn't return in a thread whose call has failed.
  void stop_if_lost();
  /// This thread makes a call that waits for something outside of the process: others run meanwhile.
  void leave_for_outside(const char* words);
  void come_back();
  TurnThread* find(pthread_t handle);
  /// The thread was joined, or has to remove itself at its end.
  void erase(TurnThread& thread);
  void detach(TurnThread& thread);
  /// Ends the wait of a thread that is cancelled.
  void interrupt(TurnThread& thread);

  // Other orders: turn_order.h.

  struct MadeExchange {
    Exchange exchange;
    std::string runs, before;  // the names of the threads; empty in an order that is drawn
    CodePlaces runs_at{}, before_at{};
    bool has_lines = false;  // the names contain the lines of these places
  };
  /// The order of the next run.
  void try_order(TurnOrder order);
  const TurnOrder* order() const { return order_ ? &*order_ : nullptr; }
  std::vector<MadeExchange>& made() { return made_; }
  /// The number of threads of the run so far, the caller among them.
  int thread_count() const { return started_ + 1; }
  /// A lock, or a wake-up of others: another thread may come first, if an order is tried.
  void consider();

  // Timers that count in a descriptor (timerfd): timers.cpp.

  struct Timer {
    int descriptor = -1;
    bool is_date = false;
    std::int64_t next = never, period = 0;  // [ns]
  };
  void add_timer(int descriptor, bool is_date);
  Timer* timer(int descriptor);
  void remove_timer(int descriptor);

  /// Called on the caller when all wait for each other; doesn't return. Null: the process ends.
  void (*on_deadlock)() = nullptr;
  /// Returns the calls in which this thread waits.
  CodePlaces (*find_places)() = nullptr;
  /// Returns the name of a function; empty: it isn't known.
  std::string (*name_of_function)(const void* function) = nullptr;

  struct Waiting {
    std::string thread, waits_for;
    CodePlaces places{};
  };
  /// What the threads wait for, the caller first. Called by the caller in a deadlock.
  std::vector<Waiting> stuck();
  /// What the threads wait for between two calls, in the order of their start.
  std::vector<Waiting> at_rest();

  struct Listed {
    long tid = 0;  // the kernel's number
    int number = 0;
    bool has_turn = false;
    const char* name = "";  // empty: it has none
    const char* waits_for = "";
  };
  /// The threads, the caller first, into `list`. Returns their number there. Allocates nothing: a debugger may call it
  /// anywhere.
  std::size_t list(std::span<Listed> list) const;

 private:
  TurnScheduler() = default;
  void pass(TurnThread& me);
  TurnThread* choose();
  std::size_t first_of_ready();
  CodePlaces places_of(TurnThread& thread) const;
  bool pass_time();
  void make_ready(TurnThread& thread, bool timed_out);
  void release_due();
  std::int64_t earliest() const;
  void fire_timers();
  std::int64_t earliest_timer() const;
  void take(TurnThread& me);
  static void give(TurnThread& next);
  bool take_arrivals();
  void remove(std::vector<TurnThread*>& from, const TurnThread& thread);
  std::int64_t delay_of(const TurnThread& thread) const;
  void note_outside(const char* words);
  std::string words_of(const TurnThread& thread) const;
  std::string name_of(const TurnThread& thread) const;
  void lose(TurnThread& thread);

  TurnThread caller_;
  std::atomic<TurnThread*> running_{&caller_};
  std::vector<TurnThread*> threads_;  // in the order of their start
  std::vector<TurnThread*> ready_;    // in the order in which they were woken
  std::vector<TurnThread*> waiting_;  // in the order of their waiting
  std::vector<Timer> timers_;
  std::atomic<TurnThread*> arrivals_{nullptr};  // threads that came back from outside, the last one first
  std::atomic<std::uint32_t> arrived_{0};       // their number so far
  int outside_ = 0;
  int started_ = 0;
  std::int64_t now_ = 0, base_ = 0;  // [ns]
  std::int64_t until_ = 0;           // while the caller rests: the time to which simulated time goes on [ns]
  bool is_stuck_ = false;
  std::optional<TurnOrder> order_;
  std::vector<MadeExchange> made_;
  OrderPlace place_;  // the next one
};

}  // namespace rehearse
