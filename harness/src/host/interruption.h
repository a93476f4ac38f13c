// Interruption: runs that end at a tick, with complete files, when the process gets SIGINT or SIGTERM.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <optional>

namespace rehearse {

/// From now on these signals end runs of this process at a tick. The same signal again, a second later, ends the
/// process at once.
void end_runs_on_signals();

/// The received signal; 0: none.
int interruption();

/// "interrupted by SIGINT before tick 12 (0.012 s)"; none: no signal was received.
std::optional<Diagnostic> interrupted_at(std::int64_t tick, double time_step);

}  // namespace rehearse
