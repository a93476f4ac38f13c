// The outcome of a check: as text for a person, as JSON for the user and between processes, and in formats for
// continuous integration.
#pragma once

#include <rehearse/check.h>
#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "output.h"

namespace rehearse::tool {

/// The result of one scenario.
struct Checked {
  std::string scenario;  // name
  std::string file;
  CheckReport report;
  std::optional<FailureReport> page;  // the report for a browser
  std::string no_page;                // the reason why there is no report although one was requested
  double seconds = 0.0;               // wall time of the check, without its report [s]
};

Exit exit_of(const CheckReport& report);

/// Prints the verdict, the levels and tables of differences. They are on stdout when this returns.
void tell_verdict(const Checked& checked);
/// Prints the notes, the files that wait for a decision, and the address of the report.
void tell_files(const Checked& checked);

/// A check as JSON, so that a process can pass it to another: `check` is the object for the user.
Json outcome_of(const Scenario& scenario, const Checked& checked);

/// One object for several scenarios: the same members as for one, and each scenario in `scenarios`.
Json json_of_checks(const std::vector<Json>& all);

/// Lists the results beside the reports, and prints the address of the list. Without a failure an existing list is
/// renewed, and no new one is made.
void keep_index(const std::vector<Scenario>& scenarios, const std::vector<Json>& all, bool tells);

/// Writes JUnit's XML, in the form of Jenkins' published schema: a test case for each scenario, whose failure has the
/// verdict as its message. Fails if the file can't be written.
Result<void> write_junit(const std::filesystem::path& file, const std::vector<Json>& all);

/// Prints workflow commands of GitHub Actions on stdout: `::error file=...,line=...::VERDICT` for each scenario that
/// didn't pass. Appends a table of all scenarios to the job's summary, the file that GITHUB_STEP_SUMMARY names, if it
/// is set.
Result<void> print_for_github(const std::vector<Json>& all);

/// True if the environment contains GITHUB_ACTIONS=true.
bool is_github();

}  // namespace rehearse::tool
