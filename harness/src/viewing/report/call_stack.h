// The source line at which a controller writes a command, found by gdb in a replay.
#pragma once

#include <rehearse/report.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace rehearse {

/// The call stack of a controller (BODY/NAME) in control() at that tick, where it changes that command last
/// (JOINT/QUANTITY; empty: at the beginning of control()). The command `rehearse` beside this library replays the
/// recording in gdb; this takes a minute at most. Fails if gdb or the command is not installed, the replay doesn't
/// reach the tick, or the controller has no debug information or no source file.
Result<CallStack> call_stack_at(const std::filesystem::path& trace, const std::string& controller,
                                const std::string& command, std::int64_t tick, const HostOptions& host);

/// ReportOptions::call_stack for controllers whose commands differ from those of `trace` (a golden); null if gdb is not
/// installed, or with REHEARSE_CALL_STACK=never in the environment.
decltype(ReportOptions::call_stack) call_stack_of(const std::filesystem::path& trace, const HostOptions& host);

}  // namespace rehearse
