// What <rehearse/gtest.h> stands on, without GoogleTest: where a test finds its files, and what its assertions do.
// C++17.
#pragma once

#include <rehearse/trace.h>

#include <string>

namespace rehearse {

struct TestFolders {
  std::string fixtures;     // scenarios and models; REHEARSE_FIXTURES in the environment wins
  std::string golden;       // goldens; REHEARSE_GOLDEN_DIR wins
  std::string output;       // gets traces/ and goldens/pending/; REHEARSE_PENDING wins over the latter
  std::string controllers;  // libraries of controllers; searched after REHEARSE_CONTROLLER_PATH
};

/// States the folders of this program; rehearse_add_controller_test does it. Empty ones keep what they were: at first
/// the working directory, and golden/ in it. True, so that it can initialise a variable.
bool set_test_folders(const TestFolders& folders);

/// The folders in force, the environment included; controllers apart.
TestFolders test_folders();

/// A path of the fixtures; absolute paths stay.
std::string fixture_path(const std::string& path);

namespace internal {

struct TestVerdict {
  bool passed = false;
  std::string message;  // why not
};

// `test` is Suite.Test.
Trace record_for_test(const std::string& scenario, const std::string& test);
TestVerdict match_golden(const Trace& trace, const std::string& test);
TestVerdict replay_golden(const std::string& name);

}  // namespace internal
}  // namespace rehearse
