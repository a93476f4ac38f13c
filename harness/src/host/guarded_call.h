// guarded_call: runs a piece of somebody else's code, and comes back whatever it does.
//
// A controller may throw, access a null pointer, call abort, overflow its stack or never return. In each case the call
// ends and says so, and the process goes on: it must still close its trace. exit is caught likewise, where it finds
// ours (process_tripwires.cpp). Signals are caught on a stack of their own and left by siglongjmp, so the interrupted
// code's destructors don't run, and what it held (memory, locks) stays held: after a crash or a hang no further code of
// that controller may be called. The calls of one process are made by one thread.
#pragma once

#include <functional>
#include <string>

#include "float_mode.h"

namespace rehearse {

enum class CallEnd {
  returned,
  threw,    // an exception left it
  crashed,  // a signal: segmentation fault, abort, ...
  hung,     // it did not return within the limit
  exited,   // it called exit, _exit, quick_exit or exec
};

struct CallOutcome {
  CallEnd end = CallEnd::returned;
  std::string what;                    // for a person: "threw std::runtime_error: no gait"; empty if it returned
  FloatMode float_mode;                // that it left behind; what was before the call has been set again
  bool changed_float_mode = false;     // it isn't the standard one
  const void* by_thread_of = nullptr;  // it was a thread that failed: of the library with this count of threads
};

/// Runs `code` in the standard floating-point mode, at most `limit` seconds of wall time [s].
CallOutcome guarded_call(const std::function<void()>& code, double limit);

/// Installs the signal handlers that end calls. The first guarded_call() does so at the latest.
void prepare_guarded_calls();

/// Code of somebody else's stays in memory until the process ends: its static destructors, which exit() runs then, may
/// crash, hang or call exit themselves; the exit status stays. To be called when that code has been loaded.
void guard_process_end();

/// Comes back unless the process is in the part of exit() that guard_process_end() guards.
void end_if_ending();

/// This is the thread that makes the guarded calls, and it is inside of one.
bool in_guarded_call();

/// Ends the guarded call that this is called in, as if the code had ended the process by `function`. `deed`: "called
/// exit(0)".
[[noreturn]] void leave_guarded_call(const char* deed);

/// A thread of a controller's own has failed. The guarded call that is under way ends for that, or else the next one;
/// the thread stands still for good, since it can't be left as a call can. `deed`: "threw std::runtime_error: ...".
[[noreturn]] void fail_on_own_thread(const char* deed);

/// This process was forked by code in a guarded call, or by a thread of a controller's own. It ends where that call
/// ends.
bool is_forked_by_guest();

/// This thread runs code of a controller: in a guarded call, or as a thread that a controller started.
bool in_controllers_code();

/// Ends the process, past all that would be called in exit().
[[noreturn]] void leave_process(int status);

/// A signal stack for this thread while it lives, so that an overflow of its ordinary stack can be survived.
class SignalStack {
 public:
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  char* memory_;
};

/// A signal by which a call that crashes or hangs is ended. It has to reach us, whatever the code says of signals.
bool ends_calls(int signal_number);

}  // namespace rehearse
