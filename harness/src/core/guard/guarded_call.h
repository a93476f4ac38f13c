// guarded_call: runs code of a controller, and returns to the host in all cases.
//
// A controller may throw, access a null pointer, call abort, overflow its stack or never return. In each case the call
// ends with a report, and the process continues, because it must still close its trace. A call of exit is caught in the
// same way, where it reaches the replacement in process_tripwires.cpp. Signals are caught on a separate stack and left
// by siglongjmp. So the destructors of the interrupted code don't run, and its memory and locks are not released. After
// a crash or a hang no further code of that controller may be called. The calls of one process are made by one thread.
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
  FloatMode float_mode;                // mode at the end of the call; the mode from before the call is restored
  bool changed_float_mode = false;     // float_mode isn't the standard one
  const void* by_thread_of = nullptr;  // not null: a thread failed, of the library with this count of threads
  const void* place = nullptr;         // the address of the code at which it crashed; null: it isn't known
};

/// The limit of a call after a signal that ends the run, whichever came later [s].
inline constexpr double limit_after_signal = 1.0;

/// Runs `code` in the standard floating-point mode, at most `limit` seconds of wall time [s], after a signal that ends
/// the run at most limit_after_signal.
CallOutcome guarded_call(const std::function<void()>& code, double limit);

/// Installs the signal handlers that end calls, and their stack for this thread, which forks have, too. The first
/// guarded_call() of a thread does so at the latest.
void prepare_guarded_calls();

/// Must be called outside of a guarded call in a process that was forked to make guarded calls of its own. The thread
/// that limits their time isn't in such a process.
void watch_calls_after_fork();

/// From now on this thread runs code of controllers until the process ends, at most `limit` [s]. Its end is that of the
/// process: end_if_ending() (process_end.h).
void guard_rest_of_process(double limit);

/// From now on a crash inside of the C library ends this process in the call, with exit status 128 + the signal. For a
/// process whose parent notices that and knows the call: without a supervisor such a call ends as others do, and the
/// next allocation may wait for ever.
void end_process_at_library_crashes();

/// True if this is the thread that makes the guarded calls, and it is inside of one.
bool in_guarded_call();

/// Ends the present guarded call, as if the code had ended the process by `function`. `deed`: "called exit(0)".
[[noreturn]] void leave_guarded_call(const char* deed);
/// Ends the present guarded call, the present thread of a controller, or the process in exit(), as if the code had
/// raised SIGABRT. `deed`: what it did instead; null: it called abort.
[[noreturn]] void abort_controllers_code(const char* deed = nullptr);

/// Reports the failure of a controller's own thread. The present guarded call ends with it, or else the next one. The
/// thread is suspended for good, because it can't be left as a call can. `deed`: "threw std::runtime_error: ...".
/// `place`: as in CallOutcome.
[[noreturn]] void fail_on_own_thread(const char* deed, const void* place = nullptr);

/// True if code in a guarded call, or a controller's own thread, has forked this process. It ends where that call ends.
bool is_forked_by_guest();

/// True if this thread runs code of a controller: in a guarded call, or as a thread that a controller started.
bool in_controllers_code();

/// A signal stack for this thread during its lifetime, so that an overflow of its ordinary stack can be handled.
class SignalStack {
 public:
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  char* memory_;
};

/// True for a signal that ends a call that crashes or hangs. The host must receive it, even if the code blocks signals.
bool ends_calls(int signal_number);

}  // namespace rehearse
