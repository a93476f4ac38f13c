// The log, which is written while the process runs.
#pragma once

#include "watching.h"

namespace rehearse::interposer {

/// Creates the log in this file. Reports a failure on stderr; then nothing is logged.
void open_log(const char* file);

/// Notes that system calls are made that can't be observed.
void say_that_calls_are_hidden();

/// Counts a call, with a new entry for the first of its kind. Returns the new entry, else null.
LogEntry* log_call(Source source, const char* function, const char* argument, const char* digest,
                   const char* controller, const char* phase, int64_t tick, const Caller& caller);

}  // namespace rehearse::interposer
