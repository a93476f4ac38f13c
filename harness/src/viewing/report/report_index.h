// The index of a test run: one page that lists the results of all tests, even of several programs. Internal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The result of one assertion of a test, or of one checked scenario.
struct TestResult {
  enum class State { passed, differs, failed };  // failed: it did not run to its end, or can't be judged

  std::string test;  // Suite.Test, or the scenario
  std::string kind;  // "golden", "expectations", "replay", "orders", "run"
  State state = State::passed;
  std::string verdict;                // a sentence
  std::filesystem::path report;       // in the folder of the index; empty: none
  std::optional<std::int64_t> tick;   // of the first difference or violation
  std::vector<std::uint8_t> picture;  // PNG of the robot at that tick; empty: none
  std::optional<double> seconds;      // wall time; none: unknown
  std::filesystem::path project;      // a folder of the git repository whose commit was tested; empty: unknown
};

/// Keeps the result, with the present moment and the commit, as FOLDER/TEST.KIND.report.json. The earlier result
/// becomes one of its previous runs, of which ten are kept. The caller must have locked the folder.
void keep_result(const std::filesystem::path& folder, const TestResult& result);
/// Removes a kept result.
void drop_result(const std::filesystem::path& folder, const std::string& test, const std::string& kind);

/// Makes FOLDER/index.html of all kept results: failed ones first. The caller must have locked the folder. Without a
/// failed test and without an existing index none is made, unless `always`. Returns the index; none: there is none.
std::optional<std::filesystem::path> refresh_index(const std::filesystem::path& folder, bool always = false);

}  // namespace rehearse
