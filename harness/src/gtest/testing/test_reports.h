// Result files of tests: a report for each failed test, and one page that lists all comparisons. Internal to the
// testing library.
#pragma once

#include <rehearse/check.h>
#include <rehearse/gtest.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "viewing/report/report_index.h"

namespace rehearse::internal {

/// The folder of traces, reports and the index.
std::filesystem::path traces_folder();

/// The comparison of a test's recording with its golden.
struct ComparedTest {
  std::filesystem::path golden;    // empty: there was no comparison
  std::filesystem::path scenario;  // empty: unknown
  std::vector<ToleranceRule> tolerances;
  std::optional<double> horizon;       // [s]
  std::optional<CheckReport> checked;  // the check on all levels; none: only the recording was compared
  CheckReport in_brief;                // what a history keeps of it, if it wasn't checked
  bool differs_in_bits_alone = false;  // the failure is a difference within tolerance
};

/// Writes traces/TEST.html in the output folder if the test failed (REHEARSE_REPORT=always: after every test; never:
/// after none), or TEST.KIND.html for another kind than "golden". Keeps the result for the index. Returns lines for the
/// test's message, each after a newline. A report that can't be written fails no test.
std::string keep_test_report(const Trace& trace, const std::string& test, const std::string& kind,
                             const TestVerdict& verdict, const ComparedTest& compared);

/// Keeps a result for traces/index.html, with a picture of the robot at its tick if it did not pass. `trace` may be
/// null: no picture. `scenario`: its file; empty: that in the recording. Programs that run at the same time keep each
/// other's results. Returns a line with the address of the index, after a newline; empty if the test passed.
std::string keep_test_result(TestResult result, const Trace* trace, const std::filesystem::path& scenario);
/// Removes a result of an earlier run from the index.
void drop_test_result(const std::string& test, const std::string& kind);

}  // namespace rehearse::internal
