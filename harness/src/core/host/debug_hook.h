// The hook for debuggers, and the variables that show the present place in a run: rehearse_at_tick() is called right
// before each control().
//
// In gdb `break rehearse_at_tick` stops there. With rehearse_stop_tick set, the function isn't called before that tick,
// and the run has full speed until then. tools/gdb/ makes commands of it. The names are C names, so that a user can
// type them. This file changes nothing in the computed or recorded data of a run.
#pragma once

namespace cnoid {
class Body;
class SimpleController;
}  // namespace cnoid

namespace rehearse {

class ControllerIo;

/// The present place of the process. tools/gdb reads it at these offsets, also without debug information.
struct DebugPlace {
  long run = 0;                               // number of the run in the process, from 1; 0: none has begun
  long tick = 0;                              // 0 until the first control()
  double time = 0.0;                          // [s] of simulation
  const char* controller = nullptr;           // "SR1/SR1Minimum"; null: no controller is being called
  const char* function = nullptr;             // "initialize", "control", ...
  cnoid::SimpleController* object = nullptr;  // null until it is created
  ControllerIo* io = nullptr;                 // its inputs and outputs
  cnoid::Body* body = nullptr;                // its body; null until initialize()
};

/// A thread of a controller that takes turns, or the thread of the calls. Likewise.
struct DebugThread {
  long tid = 0;     // the kernel's number
  long number = 0;  // 1, 2, ...: in the order of their start; 0: the thread of the calls
  long has_turn = 0;
  const char* name = nullptr;
  const char* waits_for = nullptr;
};

}  // namespace rehearse

extern "C" {

extern rehearse::DebugPlace rehearse_now;

/// Writes the threads into rehearse_threads. Returns their number; 0: none takes turns. A debugger may call it
/// anywhere.
long rehearse_list_threads();
extern rehearse::DebugThread rehearse_threads[64];

/// Set by a debugger: rehearse_at_tick() is called from that tick on, in that run and all later ones.
extern volatile long rehearse_stop_run;
extern volatile long rehearse_stop_tick;

/// Changes rehearse_watch_trial, by which a debugger finds out whether the machine's watchpoints work.
void rehearse_try_watch();
extern volatile long rehearse_watch_trial;

/// Does nothing: a place for breakpoints.
void rehearse_at_tick(long tick, const char* controller, cnoid::SimpleController* object);

}  // extern "C"

namespace rehearse {

/// Begins a new run of this process; returns its number.
inline long begin_debugged_run() {
  static long runs = 0;
  return ++runs;
}

/// Sets the place of the process during a call.
class DebuggedCall {
 public:
  explicit DebuggedCall(const DebugPlace& place) { rehearse_now = place; }
  ~DebuggedCall() {
    rehearse_now.controller = rehearse_now.function = nullptr;
    rehearse_now.object = nullptr;
    rehearse_now.io = nullptr;
    rehearse_now.body = nullptr;
  }
  DebuggedCall(const DebuggedCall&) = delete;
  DebuggedCall& operator=(const DebuggedCall&) = delete;
};

/// Must be called right before control().
inline void stop_for_debugger() {
  if (rehearse_now.tick >= rehearse_stop_tick && rehearse_now.run >= rehearse_stop_run)
    rehearse_at_tick(rehearse_now.tick, rehearse_now.controller, rehearse_now.object);
}

}  // namespace rehearse
