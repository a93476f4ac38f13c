// The processes of an audit, as their parent sees them: started with one thing changed, waited for, their results read.
#pragma once

#include <rehearse/audit.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "call_log.h"
#include "host/interposer.h"
#include "outputs_file.h"

namespace rehearse {

/// What is special about one process.
struct ReplaySettings {
  std::string name;  // of its folder
  Substitution everywhere;
  std::optional<CodePlace> only;  // then `there` holds at that place
  Substitution there;
  int passes = 1;
  unsigned char fill = 0;       // what fresh and freed memory and the stack are painted with; 0: nothing
  std::uint32_t padding = 0;    // AuditedReplay::padding
  bool other_addresses = true;  // chosen anew for each process, as usual; false: the same in all of them
  std::map<std::string, std::optional<std::string>> environment;  // variables; none: taken away
  bool other_environment = false;                                 // of all those that nothing here needs
  bool other_folder = false;                                      // works in one of its own
  bool valgrind = false;
};

/// What came of one pass.
struct ReplayPass {
  Outputs outputs;
  std::optional<std::string> failure;  // a controller threw, crashed or hung; or the process ended in it
  bool hung = false;                   // no answer; the process was killed
  bool refused = false;
  std::optional<Divergence> differs_from_recording;  // the first of its commands that isn't the recorded one
  std::string undefined;                             // under valgrind: the first number that was never set
  Diagnostics remarks;
};

struct ReplayOutcome {
  std::vector<ReplayPass> passes;
  CallLog log;
  std::string valgrind_report;  // XML
  double seconds = 0.0;         // of wall time
};

/// Runs replays of one trace, two processes at a time.
class ReplayProcesses {
 public:
  ReplayProcesses(const AuditOptions& options, std::filesystem::path trace);

  /// The outcomes in the order of the settings. Fails if a process can't be started, or if a controller can't be loaded
  /// or is not fed by the trace.
  Result<std::vector<ReplayOutcome>> run(const std::vector<ReplaySettings>& settings);
  /// Called with the number of processes that have ended.
  std::function<void(int done)> on_progress;

 private:
  struct Child;
  std::filesystem::path folder_of(const ReplaySettings& settings) const;
  std::vector<std::string> command_line(const ReplaySettings& settings) const;
  Result<std::vector<std::string>> environment(const ReplaySettings& settings) const;
  Result<Child> start(const ReplaySettings& settings);
  bool has_ended(Child& child) const;
  Result<ReplayOutcome> outcome(const Child& child) const;
  Result<ReplayPass> read_pass(const Child& child, int number) const;

  const AuditOptions& options_;
  std::filesystem::path trace_;
  int done_ = 0;
};

/// Runs a program to its end and waits; its stdout and stderr go to a file. What it exits with, 128 + n if signal n
/// ended it. Fails if it can't be started, or if it had to be killed since `should_stop` (may be null) said so.
Result<int> run_program(const std::vector<std::string>& words, const std::vector<std::string>& environment,
                        const std::filesystem::path& output, const std::function<bool()>& should_stop);

/// This process's variables with changes.
std::vector<std::string> environment_with(const std::map<std::string, std::optional<std::string>>& changes);

/// Whether a process may be started at addresses that aren't chosen by chance.
bool can_fix_addresses();

}  // namespace rehearse
