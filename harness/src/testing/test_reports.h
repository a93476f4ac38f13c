// What tests leave behind to look at: a report of each that failed, and one page that lists all that were compared.
// Internal to the testing library.
#pragma once

#include <rehearse/check.h>
#include <rehearse/test_support.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::internal {

/// How a test's recording was compared with its golden.
struct ComparedTest {
  std::filesystem::path golden;    // empty: nothing was compared
  std::filesystem::path scenario;  // empty: not known
  std::vector<ToleranceRule> tolerances;
  std::optional<double> horizon;       // [s]
  std::optional<CheckReport> checked;  // of all levels; none: the recording alone was looked at
};

/// Writes traces/TEST.html in the output folder if the test failed (REHEARSE_REPORT=always: whatever it did; never: not
/// at all), notes its verdict beside that, and makes traces/index.html anew of all such notes. Programs that run at
/// once don't lose each other's. Returns what to say of it, each line after a newline; nothing fails by it.
std::string keep_test_report(const Trace& trace, const std::string& test, const TestVerdict& verdict,
                             const ComparedTest& compared);

}  // namespace rehearse::internal
