// Where a debugger stops, and what it reads to know where it is: rehearse_at_tick() is called right before each
// control().
//
// In gdb `break rehearse_at_tick` stops there; with rehearse_stop_tick set nothing is called before that tick, and the
// run goes on at full speed until then. tools/gdb/ makes commands of it. The names are C's, so that they can be typed.
// Nothing here changes what a run computes or records.
#pragma once

namespace cnoid {
class Body;
class SimpleController;
}  // namespace cnoid

namespace rehearse {

class ControllerIo;

/// Where the process is. tools/gdb reads it at these offsets, also where there is no debug information.
struct DebugPlace {
  long run = 0;                               // the process's runs are counted from 1; 0: none has begun
  long tick = 0;                              // 0 until the first control()
  double time = 0.0;                          // [s] of simulation
  const char* controller = nullptr;           // "SR1/SR1Minimum"; null: no controller is being called
  const char* function = nullptr;             // "initialize", "control", ...
  cnoid::SimpleController* object = nullptr;  // null until it is made
  ControllerIo* io = nullptr;                 // what it reads and writes
  cnoid::Body* body = nullptr;                // its own; null until initialize()
};

}  // namespace rehearse

extern "C" {

extern rehearse::DebugPlace rehearse_now;

/// For a debugger to set: rehearse_at_tick() is called from that tick on, in that run and those after it.
extern volatile long rehearse_stop_run;
extern volatile long rehearse_stop_tick;

/// To break on. Does nothing.
void rehearse_at_tick(long tick, const char* controller, cnoid::SimpleController* object);

}  // extern "C"

namespace rehearse {

/// A new run of this process; returns its number.
long begin_debugged_run();

/// Says where the process is while a call lasts.
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

/// To be called right before control().
inline void stop_for_debugger() {
  if (rehearse_now.tick >= rehearse_stop_tick && rehearse_now.run >= rehearse_stop_run)
    rehearse_at_tick(rehearse_now.tick, rehearse_now.controller, rehearse_now.object);
}

}  // namespace rehearse
