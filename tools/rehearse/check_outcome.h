// The outcome of a check, and its writers: for the terminal, as JSON, as JUnit's XML, for GitHub, and for the list of
// reports. Each of them reads the check's result and makes its text of it.
#pragma once

#include <rehearse/check.h>
#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "explanation.h"
#include "output.h"
#include "scenario_words.h"

namespace rehearse::tool {

/// The scenario of a file, or of the recording of a robot's log, from which it is read.
Result<Scenario> read_scenario(const std::string& file, const StatedValues& values = {});

/// The result of one scenario.
struct Checked {
  std::string scenario;  // name
  std::string file;
  CheckReport report;
  std::vector<std::string> notes;     // on libraries that are out of date; they were printed before the run
  std::optional<FailureReport> page;  // the report for a browser
  std::string line_advice;            // a command that finds the line at fault; empty: none is known
  std::optional<Explanation> explanation = std::nullopt;  // of --explain
  std::string no_page;   // the reason why there is no report although one was requested
  double seconds = 0.0;  // wall time of the check, without its report [s]
};

Exit exit_of(const CheckReport& report);

/// Prints the verdict, the levels and tables of differences. They are on stdout when this returns. Of a run that failed
/// only the verdict and the levels, unless `verbose`.
void tell_verdict(const Checked& checked, bool verbose);
/// Prints the notes, the files that wait for a decision, and the address of the report. No notes of a run that failed,
/// unless `verbose`.
void tell_files(const Checked& checked, bool verbose);

/// What remains of a check when it is over.
struct CheckOutcome {
  std::string scenario;  // name
  std::string file;
  std::string kind;  // "golden" or "expectations"
  Exit exit = Exit::done;
  std::string verdict;  // one sentence
  std::string code;     // of the verdict: "controller.changed"
  bool equal = false, within = false, proved = false;
  LevelState controller = LevelState::not_compared, plant = LevelState::not_compared, closed = LevelState::not_compared;
  std::string report = {};                          // an HTML file; empty: there is none
  std::optional<std::int64_t> tick = std::nullopt;  // where the report begins
  int line = 1;                                     // of the first violated expectation, else 1
  double seconds = 0.0;                             // wall time [s]
  std::vector<std::string> notes = {};              // on libraries that are out of date
  std::string details = {};                         // the verdict, the differences and what to do, in lines
  std::string history = {};                         // the line for a history; empty: none is kept
  Json json = nullptr;                              // the object for the user; null: it wasn't wanted
};

/// `json`: with the object for the user.
CheckOutcome outcome_of(const Scenario& scenario, const Checked& checked, bool json);
/// Of a scenario that can't be read, or whose golden can't be used: status 2, and the errors as its verdict.
CheckOutcome outcome_without_verdict(const std::string& scenario, const std::string& file, bool has_golden,
                                     const Diagnostics& errors);
/// The form in which a process passes an outcome to another, and back. None: a controller damaged the form.
std::string form_of(const CheckOutcome& outcome);
std::optional<CheckOutcome> outcome_in(std::string_view form);

/// One object for several scenarios: the same members as for one, and each scenario in `scenarios`.
Json json_of_checks(const std::vector<CheckOutcome>& all);

/// Lists the scenarios that couldn't be judged on stderr, after the verdicts of the others.
void tell_unjudged(const std::vector<CheckOutcome>& all);

/// Lists the results beside the reports, and prints the address of the list. Without a failure an existing list is
/// renewed, and no new one is made.
void keep_index(const std::vector<CheckOutcome>& all, const std::filesystem::path& folder, bool tells);

/// Writes JUnit's XML, in the form of Jenkins' published schema: a test case for each scenario, whose failure has the
/// verdict as its message. Fails if the file can't be written.
Result<void> write_junit(const std::filesystem::path& file, const std::vector<CheckOutcome>& all);

/// Prints workflow commands of GitHub Actions on stdout: `::error file=...,line=...::VERDICT` for each scenario that
/// didn't pass. Appends a table of all scenarios to the job's summary, the file that GITHUB_STEP_SUMMARY names, if it
/// is set.
Result<void> print_for_github(const std::vector<CheckOutcome>& all);

/// True if the environment contains GITHUB_ACTIONS=true.
bool is_github();

}  // namespace rehearse::tool
