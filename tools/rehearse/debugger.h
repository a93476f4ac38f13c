// --gdb of replay, record and check: the verb continues in gdb, stopped in control() of a controller at a tick.
//
// The process executes gdb in its place. gdb starts the same command again without --gdb, with the same pinning, and
// loads the commands of tools/gdb.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
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

/// The values of --gdb and --gdb-arg.
struct DebuggerOptions {
  std::string gdb;                         // empty: not given; "true": without a name; else NAME or BODY/NAME
  std::vector<std::string> gdb_arguments;  // arguments for gdb itself, after those of Rehearse

  bool is_wanted() const { return !gdb.empty(); }
  /// The controller in whose control() gdb stops; empty: the first that is called in a tick.
  std::string controller() const { return gdb == "true" ? "" : gdb; }
};

/// Declares --gdb and --gdb-arg. The verb declares --tick itself.
void add_debugger_options(CLI::App& options, DebuggerOptions& debugger);

/// Replaces each WORD after `--` by --gdb-arg=WORD, if --gdb comes before `--`. `arguments`: of the verb, in their
/// order.
void spell_out_gdb_arguments(std::vector<std::string>& arguments);

/// The verb and the given arguments, without those of the named options.
std::vector<std::string> words_without(const std::vector<std::string_view>& left_out, std::string_view verb,
                                       const CLI::App& options);
/// The same without the options of the debugger and --tick.
std::vector<std::string> words_without_debugger(std::string_view verb, const CLI::App& options);

struct NamedController {
  std::string label;  // BODY/NAME
  const ScenarioController* controller;

  bool is_called(std::string_view name) const { return name == label || name == controller->name; }
};

/// The controllers in the order of their calls.
std::vector<NamedController> controllers_of(const Scenario& scenario);

/// The script that loads Rehearse's commands into gdb, in the build folder and installed.
Result<std::filesystem::path> find_gdb_script();

/// The scenario of a recording that gdb is to replay. Fails if there is no gdb, or if the recording is damaged or can
/// be read only once.
Result<Scenario> scenario_for_gdb(const std::filesystem::path& trace);

/// An error if gdb is not installed, or if the scenario has no controller of that name.
Result<void> check_debugger(const DebuggerOptions& debugger, const Scenario& scenario);
/// An error if the run doesn't reach the tick.
Result<void> check_tick(std::int64_t tick, std::int64_t ticks, double time_step);
/// Executes gdb, which starts this program with these words (the verb comes first) and stops at the tick. Returns only
/// on failure. `until_crash`: it stops where the controller crashes after that.
Exit become_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words, std::int64_t tick,
                bool until_crash = false);

/// `rehearse replay TRACE --gdb`: stops at that tick. If no tick is given, stops where a controller fails, else where
/// its commands first differ from the recorded ones, else at tick 0. Reports controllers that differ from the recorded
/// ones.
Exit replay_in_gdb(DebuggerOptions debugger, const std::filesystem::path& trace, const HostOptions& host,
                   std::vector<std::string> words, std::optional<std::int64_t> tick);
/// The same for the log of a robot; without a tick it stops at tick 0.
Exit replay_log_in_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words,
                       std::optional<std::int64_t> tick);

}  // namespace rehearse::tool
