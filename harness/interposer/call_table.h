// The log as the process fills it.
#pragma once

#include "watching.h"

namespace rehearse::interposer {

/// Begins the log in this file. Says on stderr if that can't be done; then nothing is logged.
void open_log(const char* file);

/// System calls are made that nothing here sees.
void say_that_calls_are_hidden();

/// Counts a call, with a new entry if it is the first of its kind; then that is returned, else null.
LogEntry* log_call(Source source, const char* function, const char* argument, const char* digest,
                   const char* controller, const char* phase, int64_t tick, const Caller& caller);

}  // namespace rehearse::interposer
