// Interruption: runs that end at a tick, with complete files, when the process gets SIGINT, SIGTERM or
// SIGHUP, or SIGPIPE because the reader of its output is gone.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <optional>
#include <string>

namespace rehearse {

/// From now on these signals end runs of this process at a tick. The same signal again, a second later, ends the
/// process at once. A SIGPIPE ends runs only if a controller's own printing caused it; else it ends the process.
void end_runs_on_signals();

/// True if stdout or stderr is a pipe or socket that nobody reads any more.
bool is_reader_gone();

/// Must be called when a run has closed its files, before anything is printed: ends the process by SIGPIPE if that
/// ended the run.
void end_if_reader_is_gone();

/// The received signal; 0: none.
int interruption();

/// How a call that was ended exceeded its limit: "did not return within 10 s"; "did not return within 1 s after
/// SIGTERM", if that signal ended the run (0: none). `limit`: [s].
std::string lateness(double limit, int signal_number);

/// "interrupted by SIGINT before tick 12 (0.012 s)"; none: no signal was received.
std::optional<Diagnostic> interrupted_at(std::int64_t tick, double time_step);

}  // namespace rehearse
