// guarded_call: runs a piece of somebody else's code, and comes back whatever it does.
//
// A controller may throw, access a null pointer, call abort, overflow its stack or never return. In each case the call
// ends and says so, and the process goes on: it must still close its trace. Signals are caught on a stack of their own
// and left by siglongjmp, so the interrupted code's destructors don't run, and what it held (memory, locks) stays held:
// after a crash or a hang no further code of that controller may be called. The calls of one process are made by one
// thread.
#pragma once

#include <functional>
#include <string>

namespace rehearse {

enum class CallEnd {
  returned,
  threw,    // an exception left it
  crashed,  // a signal: segmentation fault, abort, ...
  hung,     // it did not return within the limit
};

struct CallOutcome {
  CallEnd end = CallEnd::returned;
  std::string what;                 // for a person: "threw std::runtime_error: no gait"; empty if it returned
  bool changed_float_mode = false;  // it left another rounding mode or flush-to-zero behind; it has been set back
};

/// Runs `code`, at most `limit` seconds of wall time [s].
CallOutcome guarded_call(const std::function<void()>& code, double limit);

}  // namespace rehearse
