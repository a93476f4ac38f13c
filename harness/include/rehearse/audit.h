// Audit: is a controller a function of its inputs?
//
// An audit feeds the inputs of a recording to the controllers many times. It needs no physics, and uses a fresh process
// each time. The commands are compared bit for bit. The processes differ in one factor at a time: fresh memory,
// addresses, the environment, the date, random numbers, the schedule of threads. So the report can name the factor that
// a controller depends on. During the replays the controller's calls to the system are logged (harness/interposer), and
// its library is scanned.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/coverage.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct AuditOptions : HostOptions {
  std::optional<double> until;  // end of the replays [s]
  int repeat = 1;               // number of replays under each factor
  bool valgrind = false;        // one more replay under memcheck
  bool realtime = false;        // only the costs of the calls are examined, in one replay
  bool instructions = false;    // only the instructions of control() are counted, in one replay under callgrind
  bool coverage = false;        // only the executed code is found, in one replay with breakpoints
  int orders = 0;               // only so many other orders of threads are tried, unless it is 0
  /// With `orders`: receives the order that changes a command, and is replaced if it exists.
  std::filesystem::path order_file;
  /// The controllers get simulated time and seeded random numbers in all runs, instead of the system's.
  bool virtualise = false;
  std::uint64_t seed = 1;          // of the random numbers that replace the system's
  std::filesystem::path auditor;   // program with the verb `audit`, which runs the replays
  std::filesystem::path recorder;  // program with the verb `record`; needed only for a scenario
  std::filesystem::path scratch;   // folder for the files of the processes; audit() creates it, the caller removes it
  /// True: audit() kills the processes and fails. It is called repeatedly; null: never.
  std::function<bool()> should_stop;
  /// Called with the current step, the number of processes that have ended, and the number of all; null: not.
  std::function<void(const std::string& what, int done, int all)> progress;
};

/// The one condition that is different in a replay.
enum class Factor {
  nothing,      // the replay repeated without change: the real clock, the system's random numbers
  memory,       // contents of fresh and freed memory and of the stack
  addresses,    // addresses of code and data
  environment,  // environment variables of the process
  machine,      // processors, host name, load, memory, terminal, user, order of lists of folders
  folder,       // the working folder
  locale,       // a locale with a decimal comma
  clock,        // the date, and the rate of time
  random,       // the random numbers
  threads,      // the order in which threads run
  again,        // a second run in one process
  recording,    // the closed loop in which the inputs were recorded
};

/// "memory", "addresses", ...
std::string_view to_string(Factor factor);

struct FactorResult {
  Factor factor = Factor::nothing;
  int replays = 0;
  std::string not_varied;           // why the factor was not varied; empty: it was varied
  std::optional<Divergence> first;  // the earliest difference; none: all bits are equal
};

/// A call of a controller to the system, whose answer isn't one of the recorded inputs.
struct AuditedCall {
  enum class Reached {
    yes,      // a different answer changed a command
    no,       // the answer was different, and the commands were equal
    unknown,  // no factor could change the answer, or no factor did
  };
  std::string source;    // "clock", "random", "thread", "file", "network", "environment", "locale", "process"
  std::string function;  // with its argument: "clock_gettime(CLOCK_MONOTONIC)"
  std::string phase;     // "initialize", "control", ...
  std::string place;     // "Filter::update() (filter.cpp:31)"
  std::int64_t first_tick = -1, last_tick = -1;  // -1: before the run
  std::int64_t count = 0;
  Reached reached = Reached::unknown;
  std::string note;  // as "its content changed between two runs"; may be empty
};

/// "yes", "no" or "unknown".
std::string_view to_string(AuditedCall::Reached reached);

/// A finding in the file of a controller's library: an instruction or a function that it can call.
struct AuditedCode {
  std::string kind;        // "fast_math_startup", "fused_arithmetic", "processor_query", "imported_source", ...
  std::int64_t count = 0;  // instructions; 1 for a start-up function or an import
  std::string function;    // the first function that contains one, demangled; of an import: the imported function
  std::string place;       // "filter.cpp:31", without debug information "BadFilter.so+0x1139"; of an import: empty
  std::string sentence;    // for a person, complete
};

/// Calls of a controller from one place that take an unknown time (rehearse/messages.h: ControlCost).
struct AuditedCost {
  std::string cost;                              // "allocation", "release", "lock", "system call" or "exception"
  std::string function;                          // of the C library: "malloc", of `operator new`, too
  std::string phase;                             // "initialize", "control", ...
  std::string place;                             // "Filter::update() (filter.cpp:31)"
  std::vector<std::string> callers;              // of the place, in the same library, innermost first
  std::int64_t first_tick = -1, last_tick = -1;  // -1: before the run
  std::int64_t count = 0;
  /// False for calls before the run and in tick 0, where a controller may take its time.
  bool breaks_realtime() const { return phase == "control" && last_tick > 0; }
};

/// The instructions that control() executes on its thread, with the calls that it makes, by valgrind's callgrind. The
/// time in which a processor executes them isn't known from their number.
struct InstructionCounts {
  struct Call {
    std::int64_t tick = 0;
    std::uint64_t instructions = 0;
  };
  /// A line of the library, with its calls of other libraries. A library without debug information has functions only.
  struct Line {
    std::string function;  // "Filter::update()"
    std::string line;      // "filter.cpp:31"; may be empty
    std::uint64_t instructions = 0;
  };
  std::vector<Call> calls;  // in the order of ticks
  Call most;                // the call with most instructions after tick 0
  std::vector<Line> lines;  // of that call, the ten with most instructions, these first
  /// Of the calls after tick 0.
  std::uint64_t median() const;
};

struct ControllerAudit {
  std::string controller;  // "SR1/SR1Minimum"
  std::filesystem::path library;
  bool deterministic = true;
  std::string reason;  // why it is not deterministic, without the controller's name; empty: it is deterministic
  /// The factor that showed it; none: deterministic, or the library alone is the reason.
  std::optional<Factor> depends_on;
  std::optional<Divergence> first;    // the first difference under depends_on
  std::vector<FactorResult> factors;  // in the order of Factor
  std::vector<AuditedCall> calls;     // in order of their first occurrence
  std::vector<AuditedCode> code;
  std::vector<AuditedCost> costs;  // with AuditOptions::realtime, in order of their first occurrence
  /// Likewise, those of control() after tick 0 on this machine; they differ from run to run.
  ControlCosts::Count page_faults = {"page_faults"};
  std::optional<InstructionCounts> instructions;  // with AuditOptions::instructions
  std::optional<ExecutedCode> executed;           // with AuditOptions::coverage; none: the library can't be watched
  /// Calls whose answer was equal in all replays and may have reached a command: "fopen(gains.txt) called in
  /// Walker::begin() ...".
  std::vector<std::string> rests_on;
};

/// Replays in other orders of the threads of controllers.
struct TriedOrders {
  /// In this order `runs` comes first, which came after `before`: "'planner' (walk.cpp:88)".
  struct Exchange {
    std::string runs, before;
  };
  int tried = 0;
  std::int64_t places = 0;          // of a replay, where several threads were ready
  int threads = 1;                  // the calls themselves among them
  std::optional<Divergence> first;  // in the fewest exchanges; none: all orders gave the same commands
  std::vector<Exchange> exchanges;
  std::filesystem::path file;  // AuditOptions::order_file, if an order matters
};

struct AuditReport {
  std::string verdict;  // one sentence, without a full stop
  bool deterministic = true;
  std::optional<bool> realtime_safe;  // none: it wasn't examined, or the costs can't be counted here
  std::optional<Diagnostic> failure;  // a controller threw, crashed, hung or ended its process
  bool controller_refused = false;
  std::int64_t ticks = 0;     // number of ticks of a replay
  std::int64_t commands = 0;  // number of commanded numbers of a replay
  int replays = 0;
  double time = 0.0;       // simulated time of a replay [s]
  double time_step = 0.0;  // [s]
  std::vector<ControllerAudit> controllers;
  std::optional<TriedOrders> orders;       // with AuditOptions::orders
  std::vector<std::string> memory_errors;  // errors that valgrind reported; sentences
  Diagnostics remarks;                     // changes that controllers made to the process, and similar remarks
};

/// Audits a trace, or a scenario, which is recorded first in a separate process. Fails if the trace or scenario cannot
/// be read, if a controller doesn't load or if a process can't be started.
Result<AuditReport> audit(const std::filesystem::path& scenario_or_trace, const AuditOptions& options);

/// The path of the recording that audit() makes of a scenario, in the folder `scratch`.
std::filesystem::path recording_of_audit(const std::filesystem::path& scratch);

/// A JSON object. Its members verdict, deterministic, first, factors, calls and library describe the first controller
/// that isn't a function of its inputs (else the first controller). Its other members are controllers (each with all of
/// these members), failure, memory_errors, replays, remarks.
std::string to_json(const AuditReport& report);

/// One of the replays of an audit. audit() runs each in a separate process.
struct AuditedReplay {
  std::filesystem::path trace;
  std::filesystem::path folder;   // folder for its results: 1.outputs and 1.json, 2.outputs and 2.json, ...
  int passes = 1;                 // number of runs in this process; libraries stay loaded between them
  std::uint32_t padding = 0;      // seed of the memory blocks that are allocated first and kept; 0: none
  std::optional<int> stack_fill;  // byte that fills the stack before each call
  bool instructions = false;      // under callgrind: write a profile of each control()
  bool costs = false;             // log the costs of calls with their places
  bool coverage = false;          // find the executed code
  std::filesystem::path order;    // file of an order of threads; empty: the usual one
  std::optional<double> until;    // [s]
  HostOptions host;
};

/// Makes the replay in this process, and writes the results of the controllers into the folder. Fails only if they
/// can't be written.
Result<void> make_audited_replay(const AuditedReplay& replay);

}  // namespace rehearse
