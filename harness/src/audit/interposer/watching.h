// Determines the caller of an interposed function, and logs its calls.
#pragma once

#include <stdint.h>

#include "log_format.h"
#include "settings.h"

namespace rehearse::interposer {

/// In the order of ObservedCall::Source.
enum class Source : uint32_t { clock, random, thread, file, network, environment, locale, process, cost, none };

/// The lead of a thread's simulated clocks over the simulation, caused by readings and sleeping.
struct ClockLead {
  uint64_t call = 0;   // number of the call in which these values were valid
  int64_t run = 0;     // time that the clocks advanced by the simulation alone [ns]
  int64_t passed = 0;  // additional time [ns]
};

struct ThreadState {
  bool in_call = false;     // between enter and leave
  bool own_thread = false;  // a controller created it
  bool busy = false;        // in code of the interposer: calls from it belong to no controller
  ClockLead lead[2];        // by layer: events at one place don't change the others
};
extern __thread ThreadState thread_state;  // NOLINT(bugprone-dynamic-static-initializers): it is constant

inline bool watching() { return (thread_state.in_call || thread_state.own_thread) && !thread_state.busy; }

/// True if this thread takes turns (core/turns/scheduler.h).
bool takes_turns();
/// True if a thread would take turns that this one starts with the function.
bool will_take_turns(const void* function);

/// The present call into a controller, or the last one.
struct CurrentCall {
  uint64_t number = 0;
  int64_t tick = -1;
  double time = 0.0;  // [s]
};
CurrentCall current_call();

/// The caller of an interposed function.
struct Caller {
  bool is_controller = false;  // false: the host itself, which is not logged
  bool is_only = false;        // it is the selected place
  const char* module = "";
  uint64_t offset = 0;  // virtual address in it
  uint32_t chain_length = 0;
  struct {
    const char* module;
    uint64_t offset;
  } chain[max_chain];
};

/// Determines the caller by the stack, and logs the call if it is a controller's. `argument` and `digest` may be null.
/// `return_address`: of the interposed function.
Caller note(Source source, const char* function, const char* argument, void* return_address,
            const char* digest = nullptr);

/// The two steps of note(): find the caller, log the call.
Caller find_caller(void* return_address);
void note(const Caller& caller, Source source, const char* function, const char* argument,
          const char* digest = nullptr);

/// The folder of the process's copies of files; empty: it has none.
const char* folder_of_copies();

/// The answers for calls by this caller, instead of the system's.
const Substitution& substitution_for(const Caller& caller);
const Substitution& substitution_of_layer(int layer);

/// During its lifetime, calls of this thread are passed through.
class Busy {
 public:
  Busy() : before_(thread_state.busy) { thread_state.busy = true; }
  ~Busy() { thread_state.busy = before_; }

 private:
  bool before_;
};

/// A number as text.
struct Digits {
  char text[24];
  explicit Digits(long long number);
  operator const char*() const { return text; }
};

}  // namespace rehearse::interposer
