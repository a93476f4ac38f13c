// --gdb of replay, record and check: the verb goes on in gdb, stopped in control() of a controller at a tick.
//
// The process becomes gdb, which starts the same command again without --gdb, pinned as this process is, with the
// commands of tools/gdb loaded.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>

#include <CLI/App.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"

namespace rehearse::tool {

/// What --gdb and its companions say.
struct DebuggerOptions {
  std::string gdb;                         // empty: not asked for; "true": without a name; else NAME or BODY/NAME
  std::vector<std::string> gdb_arguments;  // gdb's own, behind ours

  bool is_wanted() const { return !gdb.empty(); }
  /// In whose control() to stop; empty: the first that is called in a tick.
  std::string controller() const { return gdb == "true" ? "" : gdb; }
};

/// --gdb and --gdb-arg. The verb has a --tick of its own.
void add_debugger_options(CLI::App& options, DebuggerOptions& debugger);

/// Behind `--` stand words for gdb, if --gdb stands before it: makes --gdb-arg=WORD of them. `arguments`: of the verb,
/// in their order.
void spell_out_gdb_arguments(std::vector<std::string>& arguments);

/// The verb and the arguments that it was given, without those of the debugger and --tick.
std::vector<std::string> words_without_debugger(std::string_view verb, const CLI::App& options);

/// A mistake if gdb isn't there, or if the scenario has no such controller.
Result<void> check_debugger(const DebuggerOptions& debugger, const Scenario& scenario);
/// A mistake if the run has no such tick.
Result<void> check_tick(std::int64_t tick, std::int64_t ticks, double time_step);
/// Becomes gdb, which starts this program with these words (the verb comes first) and stops at the tick. Comes back
/// only if it can't.
Exit become_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words, std::int64_t tick);

/// `rehearse replay TRACE --gdb`: at that tick; if none is given, where a controller fails, else where its commands
/// differ first from the recorded ones, else at tick 0. Says of controllers that aren't the recorded ones.
Exit replay_in_gdb(DebuggerOptions debugger, const std::filesystem::path& trace, const HostOptions& host,
                   std::vector<std::string> words, std::optional<std::int64_t> tick);
/// The same of a robot's log, of which nothing is known before.
Exit replay_log_in_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words,
                       std::optional<std::int64_t> tick);

}  // namespace rehearse::tool
