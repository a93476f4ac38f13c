// Writes the results of a check in the formats of continuous integration.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse::tool {

/// The result of one scenario.
struct CiCase {
  enum class State { passed, differs, failed };  // failed: a controller failed, or nothing was compared

  std::string name;
  std::string file;  // of the scenario
  int line = 1;      // of the first violated expectation, else 1
  State state = State::passed;
  std::string verdict;   // one sentence
  std::string details;   // lines
  std::string report;    // an HTML file; empty: there is none
  double seconds = 0.0;  // wall time [s]
};

/// Writes JUnit's XML, in the form of Jenkins' published schema: a test case for each scenario, whose failure has the
/// verdict as its message. Fails if the file can't be written.
Result<void> write_junit(const std::filesystem::path& file, const std::vector<CiCase>& cases);

/// Prints workflow commands of GitHub Actions on stdout: `::error file=...,line=...::VERDICT` for each scenario that
/// didn't pass. Appends a table of all scenarios to the job's summary, the file that GITHUB_STEP_SUMMARY names, if it
/// is set.
Result<void> print_for_github(const std::vector<CiCase>& cases);

/// True if the environment contains GITHUB_ACTIONS=true.
bool is_github();

}  // namespace rehearse::tool
