// Coverage: the lines and branches of controllers that the replays of recordings execute.
//
// It needs no special build: the lines are those of the library's debug information (-g), and breakpoints find out when
// each is reached first. In an optimised library several lines may share an instruction, and a line may have none. Such
// a library is named in the remarks, and its lines without code of their own aren't known unless they are executed. A
// library that is compiled with -O0 or -Og has the lines of its source.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct AuditOptions;

/// The code of one library that a replay executed. Addresses are those of the library's file, ticks those of the first
/// time; -1: before the run.
struct ExecutedCode {
  struct Jump {
    std::optional<std::int64_t> taken, passed;  // tick
    bool is_complete = true;                    // false: it went one way 10,000 times, and was no longer watched
  };
  std::map<std::uint64_t, std::int64_t> statements;
  std::map<std::uint64_t, Jump> jumps;  // conditional jumps that were reached
};

/// The first time that code was executed.
struct FirstExecution {
  std::filesystem::path recording;
  std::int64_t tick = 0;       // -1: before the run
  std::optional<double> time;  // of that tick in the recording [s]; none: before the run
};

/// One of the two ways of a conditional jump in the library. A condition of the source may need several jumps.
struct CoveredWay {
  std::optional<FirstExecution> first;  // none: never
  bool is_known = true;                 // false: it may have been executed after the jump was no longer watched
};

struct CoveredLine {
  int line = 0;
  std::string function;                 // the first with code of this line: "Filter::update()"
  std::int64_t recordings = 0;          // number of recordings that execute the line
  std::optional<FirstExecution> first;  // none: never
  std::vector<CoveredWay> ways;         // of its jumps, two for each; empty if it never jumps
};

struct CoveredFile {
  std::filesystem::path file;  // absolute, unless the compiler left out its folder
  std::vector<CoveredLine> lines;
  /// Of optimised libraries, the lines that may have been executed or not: no statement of them was reached, and they
  /// have no code of their own, or a part of their code was executed among other lines. They aren't in `lines`.
  std::vector<int> unknown;
};

struct CoverageReport {
  std::string verdict;  // one sentence, without a full stop
  std::vector<std::filesystem::path> recordings;
  std::vector<CoveredFile> files;     // by path
  std::optional<Diagnostic> failure;  // a controller failed in a replay; what it executed until then counts
  Diagnostics remarks;                // as libraries without debug information
};

/// Replays each recording once, and adds up what their controllers execute. `options`: as for audit(). Fails if a
/// recording can't be read, if a controller can't be loaded, or if no library has lines, as of controllers in Python.
Result<CoverageReport> coverage(const std::vector<std::filesystem::path>& recordings, const AuditOptions& options);

/// A JSON object with the members of the report.
std::string to_json(const CoverageReport& report);

/// The report as a tracefile of lcov (geninfo(1), "TRACE FILE FORMAT"), for genhtml and services that read it. The
/// count of a line is the number of recordings that execute it.
std::string to_lcov(const CoverageReport& report);

}  // namespace rehearse
