// The results of a check in the forms that continuous integration reads.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse::tool {

/// One scenario that was checked.
struct CiCase {
  enum class State { passed, differs, failed };  // failed: a controller failed, or nothing was compared

  std::string name;
  std::string file;  // of the scenario
  int line = 1;      // of the expectation that is violated first, else 1
  State state = State::passed;
  std::string verdict;  // one sentence
  std::string details;  // lines
  std::vector<std::string> pictures;  // files
  double seconds = 0.0;               // wall time [s]
};

/// JUnit's XML, in the form that Jenkins publishes a schema of: a test case for each scenario, whose failure has the
/// verdict for a message. Fails if the file can't be written.
Result<void> write_junit(const std::filesystem::path& file, const std::vector<CiCase>& cases);

/// Workflow commands of GitHub Actions on stdout: `::error file=...,line=...::VERDICT` for each scenario that didn't pass.
/// Appends a table of all to the job's summary, the file that GITHUB_STEP_SUMMARY names, if it is set.
Result<void> print_for_github(const std::vector<CiCase>& cases);

/// GITHUB_ACTIONS=true in the environment.
bool is_github();

}  // namespace rehearse::tool
