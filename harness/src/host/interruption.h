// Interruption: runs that end at a tick, with all they write closed, when somebody ends the process by SIGINT or
// SIGTERM.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <optional>

namespace rehearse {

/// From now on runs of this process end so. The same signal again, a second later, ends the process at once.
void end_runs_on_signals();

/// The signal that came; 0: none.
int interruption();

/// "interrupted by SIGINT before tick 12 (0.012 s)"; none: it wasn't.
std::optional<Diagnostic> interrupted_at(std::int64_t tick, double time_step);

}  // namespace rehearse
