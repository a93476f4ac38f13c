// Whose call is it? What every interposed function asks first, and how it is noted.
#pragma once

#include <stdint.h>

#include "log_format.h"
#include "settings.h"

namespace rehearse::interposer {

/// In the order of ObservedCall::Source.
enum class Source : uint32_t { clock, random, thread, file, network, environment, locale, process };

/// How far readings and sleeping have moved the simulated clocks of a thread ahead of the simulation.
struct ClockLead {
  uint64_t call = 0;   // number of the call in which this was true
  int64_t run = 0;     // [ns] that the clocks had run by the simulation alone
  int64_t passed = 0;  // [ns] more
};

struct ThreadState {
  bool in_call = false;     // between enter and leave
  bool own_thread = false;  // a controller created it
  bool busy = false;        // in our own code: whatever it calls is nobody else's
  ClockLead lead[2];        // by layer: what happens at one place changes nothing for the others
};
extern __thread ThreadState thread_state;  // NOLINT(bugprone-dynamic-static-initializers): it is constant

inline bool watching() { return (thread_state.in_call || thread_state.own_thread) && !thread_state.busy; }

/// The call into a controller that is under way, or was the last.
struct CurrentCall {
  uint64_t number = 0;
  int64_t tick = -1;
  double time = 0.0;  // [s]
};
CurrentCall current_call();

/// Who called an interposed function.
struct Caller {
  bool is_controller = false;  // else it is the host itself, and none of our business
  bool is_only = false;        // it is the place that was named
  const char* module = "";
  uint64_t offset = 0;  // virtual address in it
  uint32_t chain_length = 0;
  struct {
    const char* module;
    uint64_t offset;
  } chain[max_chain];
};

/// Finds out by the stack, notes the call if it is a controller's, and says who it was. `argument` and `digest` may be
/// null. `return_address`: of the interposed function.
Caller note(Source source, const char* function, const char* argument, void* return_address,
            const char* digest = nullptr);

/// The same in two steps: who called, and the note.
Caller find_caller(void* return_address);
void note(const Caller& caller, Source source, const char* function, const char* argument,
          const char* digest = nullptr);

/// The folder of the process's own copies of files; empty: it has none.
const char* folder_of_copies();

/// What a call by this caller is given instead of the system's answers.
const Substitution& substitution_for(const Caller& caller);
const Substitution& substitution_of_layer(int layer);

/// While it lives, what this thread calls is passed through.
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
