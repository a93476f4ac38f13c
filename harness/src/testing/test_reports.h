// Result files of tests: a report for each failed test, and one page that lists all comparisons. Internal to the
// testing library.
#pragma once

#include <rehearse/check.h>
#include <rehearse/test_support.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::internal {

/// The comparison of a test's recording with its golden.
struct ComparedTest {
  std::filesystem::path golden;    // empty: there was no comparison
  std::filesystem::path scenario;  // empty: unknown
  std::vector<ToleranceRule> tolerances;
  std::optional<double> horizon;       // [s]
  std::optional<CheckReport> checked;  // the check on all levels; none: only the recording was compared
};

/// Writes traces/TEST.html in the output folder if the test failed (REHEARSE_REPORT=always: after every test; never:
/// after none). Writes a note of its verdict beside it, and makes traces/index.html of all such notes. Programs that
/// run at the same time keep each other's notes. Returns lines for the test's message, each after a newline; nothing
/// fails because of it.
std::string keep_test_report(const Trace& trace, const std::string& test, const TestVerdict& verdict,
                             const ComparedTest& compared);

}  // namespace rehearse::internal
