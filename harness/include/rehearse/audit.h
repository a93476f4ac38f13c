// Audit: is a controller a function of its inputs?
//
// A recording's inputs are fed to the controllers again and again, without physics, in a fresh process each time, and
// what they command is compared bit for bit. The processes differ in one thing at a time (what fresh memory holds, the
// addresses, the environment, the date, the random numbers, the threads' schedules), so that what a controller depends
// on can be named. What it asked of the system meanwhile is observed (harness/interposer), and its library is looked
// at.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct AuditOptions : HostOptions {
  std::optional<double> until;  // the replays end there [s]
  int repeat = 1;               // so many replays under each change
  bool valgrind = false;        // one more under memcheck
  /// The controllers get simulated time and seeded random numbers in all runs, instead of the system's.
  bool virtualise = false;
  std::uint64_t seed = 1;          // of the random numbers that replace the system's
  std::filesystem::path auditor;   // the program with the verb `audit`, which the replays run in
  std::filesystem::path recorder;  // the program with the verb `record`; only for a scenario
  std::filesystem::path scratch;   // a folder for what the processes write; it is made, and left to the caller
  /// True: end now; the processes are killed, and audit() fails. Asked again and again; null: never.
  std::function<bool()> should_stop;
  /// What is done now, and how many processes of how many have ended; null: not.
  std::function<void(const std::string& what, int done, int all)> progress;
};

/// What was different in a replay.
enum class Factor {
  nothing,      // twice as it is: the real clock, the system's random numbers
  memory,       // what fresh and freed memory and the stack hold
  addresses,    // where things are in memory
  environment,  // the process's variables
  machine,      // processors, host name, load, memory, terminal, user
  folder,       // the working folder
  locale,       // a decimal comma
  clock,        // the date, and how fast time runs
  random,       // the random numbers
  threads,      // which thread comes first
  again,        // a second run in one process
  recording,    // the closed loop, in which the inputs were recorded
};

/// "memory", "addresses", ...
std::string_view to_string(Factor factor);

struct FactorResult {
  Factor factor = Factor::nothing;
  int replays = 0;
  std::string not_varied;           // why there were none; empty: there were
  std::optional<Divergence> first;  // the earliest difference; none: the same bits
};

/// Something that a controller asked of the system.
struct AuditedCall {
  enum class Reached {
    yes,      // what it was answered changed a command
    no,       // it was answered otherwise, and the commands were the same
    unknown,  // nothing could give it another answer, or nothing did
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

/// Something that its library holds.
struct AuditedCode {
  std::string kind;
  std::int64_t count = 0;
  std::string function, place, sentence;
};

struct ControllerAudit {
  std::string controller;  // "SR1/SR1Minimum"
  std::filesystem::path library;
  bool deterministic = true;
  std::string reason;                 // why not, without the name; empty: it is
  std::optional<Factor> depends_on;   // that found it; none if it is deterministic, or if its library was enough
  std::optional<Divergence> first;    // of depends_on
  std::vector<FactorResult> factors;  // in the order of Factor
  std::vector<AuditedCall> calls;     // in order of their first occurrence
  std::vector<AuditedCode> code;
  /// What was the same in all replays, and may have reached a command: "fopen(gains.txt) called in Walker::begin()
  /// ...".
  std::vector<std::string> rests_on;
};

struct AuditReport {
  std::string verdict;  // one sentence, without a full stop
  bool deterministic = true;
  std::optional<Diagnostic> failure;  // a controller threw, crashed, hung or ended its process
  bool controller_refused = false;
  std::int64_t ticks = 0;     // of a replay
  std::int64_t commands = 0;  // numbers of a replay
  int replays = 0;
  double time = 0.0;  // [s] of simulation
  std::vector<ControllerAudit> controllers;
  std::vector<std::string> memory_errors;  // of valgrind; sentences
  Diagnostics remarks;                     // what controllers did to the process, and the like
};

/// Of a trace, or of a scenario, which is recorded first, in a process of its own. Fails if neither can be had, if a
/// controller doesn't load or if a process can't be started.
Result<AuditReport> audit(const std::filesystem::path& scenario_or_trace, const AuditOptions& options);

/// The recording that audit() made of a scenario, in its scratch folder.
std::filesystem::path recording_of_audit(const std::filesystem::path& scratch);

/// An object with verdict, deterministic, first, factors, calls and library of the first controller that isn't a
/// function of its inputs (else of the first), controllers (each with all of that), failure, memory_errors, replays,
/// remarks.
std::string to_json(const AuditReport& report);

/// One of the replays, which audit() gives to a process of its own.
struct AuditedReplay {
  std::filesystem::path trace;
  std::filesystem::path folder;   // for what comes of it: 1.outputs and 1.json, 2.outputs and 2.json, ...
  int passes = 1;                 // so many in this one process; libraries stay loaded between them
  std::uint32_t padding = 0;      // seed of what is allocated before, and kept; 0: nothing
  std::optional<int> stack_fill;  // a byte that the stack is painted with before each call
  std::optional<double> until;    // [s]
  HostOptions host;
};

/// Does the work, in this process. What the controllers came to stands in the folder; fails only if that can't be
/// written.
Result<void> make_audited_replay(const AuditedReplay& replay);

}  // namespace rehearse
