// The part of <rehearse/gtest.h> that needs no GoogleTest: the folders of a test's files, and the implementation of its
// assertions. C++17.
#pragma once

#include <rehearse/trace.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The folders that a test program reads and writes.
struct TestFolders {
  std::string fixtures;  // scenarios and models; REHEARSE_FIXTURES in the environment overrides it
  std::string golden;    // goldens; REHEARSE_GOLDEN_DIR overrides it
  /// Parent of traces/, which has the reports, and of goldens/pending/; REHEARSE_PENDING overrides the latter.
  std::string output;
  std::string controllers;  // libraries of controllers; searched after REHEARSE_CONTROLLER_PATH
};

/// Sets the folders of this program; rehearse_add_controller_test calls it. An empty member leaves the folder
/// unchanged: at first the working directory, and golden/ in it. Returns true, so that it can initialise a variable.
bool set_test_folders(const TestFolders& folders);

/// The folders in use, including overrides by the environment, except for controllers.
TestFolders test_folders();

/// A path in the fixtures folder; absolute paths are returned unchanged.
std::string fixture_path(const std::string& path);

// Further arguments of EXPECT_MATCHES_GOLDEN after the recording, in any order.

/// All bits must be equal, independent of the scenario's tolerances. A Near before or after it makes an exception.
struct Exact {};

/// The allowed difference of matching series from the golden: |x - g| <= max(atol, rtol * scale). It comes after the
/// rules of the scenario; the last rule that matches a series decides alone.
struct Near {
  std::string channel;  // a pattern, as SR1/*/q
  double atol = 0.0;    // in the unit of the series
  double rtol = 0.0;    // of the largest magnitude of the series in the golden
};

/// Values are compared up to this time, instead of the scenario's horizon.
struct Until {
  double time = 0.0;  // [s]
};

/// The part of the loop that is compared with the golden.
enum class Level {
  controller,  // the golden's inputs are fed to the controllers, without physics: their commands have equal bits
  plant,       // the golden's commands move the world, from checkpoint to checkpoint
  closed,      // the whole recording is compared
};

/// The levels to compare; without it closed alone. If closed differs, the other levels are run as well, to find the
/// faulty part.
struct Levels {
  /// In any order.
  Levels(std::initializer_list<Level> wanted) : levels(wanted) {}
  std::vector<Level> levels;  // that are compared
};

/// The cases of a test with variations (gtest.h: sweep).
struct SweepCases {
  std::int64_t cases = 100;  // number of variations
  std::uint64_t seed = 0;    // of their values
  int jobs = 0;              // worker processes; 0: one for each processor
  double case_limit = 60.0;  // wall time of a case; a longer one counts as hung [s]
};

/// The results of a test with variations.
struct SweepResult {
  std::int64_t cases = 0;   // that have a result
  std::int64_t passed = 0;  // of them
  double low = 0.0;         // lower bound of the share that passes: Wilson's interval with 95 % confidence
  double high = 1.0;        // its upper bound
  std::string verdict;      // a sentence: "197 of 200 cases pass: ..."
  std::string failures;     // the kinds of failures, a line each, with the command that makes the first case again
  bool repeats = true;      // cases that ran twice gave the same bits
  std::string folder;       // of the campaign, with its report
};

namespace internal {

struct TestVerdict {
  bool passed = false;
  std::string message;  // why it did not pass
};

/// All options of EXPECT_MATCHES_GOLDEN.
struct MatchOptions {
  bool exact = false;
  std::vector<Near> near;
  std::optional<double> until;  // [s]
  std::vector<Level> levels{Level::closed};
};

inline void take(MatchOptions& options, Exact) { options.exact = true; }
inline void take(MatchOptions& options, const Near& near) { options.near.push_back(near); }
inline void take(MatchOptions& options, Until until) { options.until = until.time; }
inline void take(MatchOptions& options, const Levels& levels) { options.levels = levels.levels; }

// `test` is Suite.Test.
Trace record_for_test(const std::string& scenario, const std::string& test);
TestVerdict match_golden(const Trace& trace, const std::string& test, const MatchOptions& options = {});
TestVerdict hold_expectations(const Trace& trace, const std::string& test);
TestVerdict replay_golden(const std::string& name, const std::string& test);
SweepResult sweep_for_test(const std::string& scenario, const SweepCases& cases, const std::string& test);
TestVerdict judge_pass_rate(const SweepResult& result, double rate);

}  // namespace internal
}  // namespace rehearse
