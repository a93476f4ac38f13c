// The child processes of an audit: starts them with one changed condition, waits for them, reads their results.
#pragma once

#include <rehearse/audit.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "call_log.h"
#include "core/guard/child_process.h"
#include "core/host/interposer.h"
#include "core/host/turn_order_file.h"
#include "outputs_file.h"

namespace rehearse {

/// The tool of valgrind under which a process runs.
enum class ValgrindTool { none, memcheck, callgrind };

/// The settings of one process.
struct ReplaySettings {
  std::string name;  // name of its folder
  Substitution everywhere;
  std::optional<CodePlace> only;  // if set, `there` is valid at that place only
  Substitution there;
  int passes = 1;
  unsigned char fill = 0;       // fills fresh and freed memory and the stack; 0: not filled
  std::uint32_t padding = 0;    // AuditedReplay::padding
  bool other_addresses = true;  // random for each process, as usual; false: equal in all of them
  EnvironmentChanges environment;
  bool other_environment = false;  // replaces all variables that the audit doesn't need
  bool other_folder = false;       // works in a separate folder
  ValgrindTool valgrind = ValgrindTool::none;
  std::filesystem::path order;  // AuditedReplay::order
  bool costs = false;           // AuditedReplay::costs
  bool coverage = false;        // AuditedReplay::coverage
};

/// The places of a pass where another thread could have come first, and where one did.
struct PassOrder {
  std::int64_t places = 0;
  int threads = 1;  // the caller among them
  std::vector<NamedExchange> made;
};

/// The result of one pass.
struct ReplayPass {
  Outputs outputs;
  std::optional<std::string> failure;  // a controller threw, crashed or hung; or the process ended in it
  bool refused = false;
  bool counted_costs = false;
  std::map<std::string, ControlCosts::Count> page_faults;  // by controller; empty: costs weren't counted
  std::optional<Divergence> differs_from_recording;        // the first command that differs from the recorded one
  std::optional<Divergence> beyond;                        // the first command beyond its tolerance
  std::string undefined;                                   // under valgrind: the first number that was never set
  Diagnostics remarks;
  std::map<std::filesystem::path, ExecutedCode> executed;  // by library, with ReplaySettings::coverage
  std::optional<PassOrder> order;                          // of a process that was given an order
};

struct ReplayOutcome {
  std::vector<ReplayPass> passes;
  CallLog log;
  std::string valgrind_report;                // of memcheck, XML
  std::filesystem::path instruction_profile;  // of callgrind
};

/// Runs replays of one trace, two processes at a time.
class ReplayProcesses {
 public:
  ReplayProcesses(const AuditOptions& options, std::filesystem::path trace);

  /// The outcomes in the order of the settings. Fails if a process can't be started, if a controller can't be loaded,
  /// or if the trace lacks its inputs.
  Result<std::vector<ReplayOutcome>> run(const std::vector<ReplaySettings>& settings);
  /// Called when a process has ended; null: nothing is called.
  std::function<void()> on_progress;

 private:
  struct Child;
  std::filesystem::path folder_of(const ReplaySettings& settings) const;
  std::filesystem::path profile_of(const ReplaySettings& settings) const;
  std::vector<std::string> command_line(const ReplaySettings& settings) const;
  Result<std::vector<std::string>> environment(const ReplaySettings& settings) const;
  Result<Child> start(const ReplaySettings& settings);
  bool has_ended(Child& child) const;
  Result<ReplayOutcome> outcome(const Child& child) const;
  Result<ReplayPass> read_pass(const Child& child, int number) const;

  const AuditOptions& options_;
  std::filesystem::path trace_;
};

}  // namespace rehearse
