// What <rehearse/gtest.h> stands on, without GoogleTest: where a test finds its files, and what its assertions do.
// C++17.
#pragma once

#include <rehearse/trace.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct TestFolders {
  std::string fixtures;     // scenarios and models; REHEARSE_FIXTURES in the environment wins
  std::string golden;       // goldens; REHEARSE_GOLDEN_DIR wins
  std::string output;       // gets traces/, with reports, and goldens/pending/; REHEARSE_PENDING wins over the latter
  std::string controllers;  // libraries of controllers; searched after REHEARSE_CONTROLLER_PATH
};

/// States the folders of this program; rehearse_add_controller_test does it. Empty ones keep what they were: at first
/// the working directory, and golden/ in it. True, so that it can initialise a variable.
bool set_test_folders(const TestFolders& folders);

/// The folders in force, the environment included; controllers apart.
TestFolders test_folders();

/// A path of the fixtures; absolute paths stay.
std::string fixture_path(const std::string& path);

// What EXPECT_MATCHES_GOLDEN may be told beside the recording, in any order.

/// The same bits, everywhere, whatever the scenario tolerates. A Near after it or before it makes an exception.
struct Exact {};

/// How far the series that match may be from the golden: |x - g| <= max(atol, rtol * scale). It comes behind the rules
/// of the scenario, and the last rule that matches a series decides alone.
struct Near {
  std::string channel;  // a pattern, as SR1/*/q
  double atol = 0.0;    // in the unit of the series
  double rtol = 0.0;    // of the largest magnitude of the series in the golden
};

/// Values are compared up to then; instead of the scenario's horizon.
struct Until {
  double time = 0.0;  // [s]
};

/// What of the loop is compared with the golden.
enum class Level {
  controller,  // the golden's inputs into the controllers, without physics: the same commands, bit for bit
  plant,       // the golden's commands into the world, from checkpoint to checkpoint
  closed,      // the recording
};

/// These levels; closed alone if not said. Where closed differs, the others are run all the same, to name the guilty
/// part.
struct Levels {
  Levels(std::initializer_list<Level> wanted) : levels(wanted) {}
  std::vector<Level> levels;
};

namespace internal {

struct TestVerdict {
  bool passed = false;
  std::string message;  // why not
};

/// All that EXPECT_MATCHES_GOLDEN was told.
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
TestVerdict hold_expectations(const Trace& trace);
TestVerdict replay_golden(const std::string& name);

}  // namespace internal
}  // namespace rehearse
