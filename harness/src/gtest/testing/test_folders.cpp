#include <rehearse/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

TestFolders& stated_folders() {
  static TestFolders folders{".", "golden", ".", ""};
  return folders;
}

std::string environment_or(const char* variable, const std::string& otherwise) {
  const char* value = std::getenv(variable);
  return value && *value ? value : otherwise;
}

/// Appends a folder after those of the user, so that a test can be run with different controllers.
void search_controllers_in(const std::string& folder) {
  const std::string before = environment_or("REHEARSE_CONTROLLER_PATH", "");
  if ((":" + before + ":").find(":" + folder + ":") != std::string::npos) return;
  setenv("REHEARSE_CONTROLLER_PATH", (before.empty() ? folder : before + ":" + folder).c_str(), 1);
}

}  // namespace

bool set_test_folders(const TestFolders& folders) {
  TestFolders& stated = stated_folders();
  if (!folders.fixtures.empty()) stated.fixtures = folders.fixtures;
  if (!folders.golden.empty()) stated.golden = folders.golden;
  if (!folders.output.empty()) stated.output = folders.output;
  if (!folders.controllers.empty()) search_controllers_in(stated.controllers = folders.controllers);
  return true;
}

TestFolders test_folders() {
  TestFolders folders = stated_folders();
  folders.fixtures = environment_or("REHEARSE_FIXTURES", folders.fixtures);
  folders.golden = environment_or("REHEARSE_GOLDEN_DIR", folders.golden);
  return folders;
}

std::string fixture_path(const std::string& path) { return (fs::path(test_folders().fixtures) / path).string(); }

}  // namespace rehearse
