// Functions for tests of scenarios: write a text to a file, load it, return the diagnostics.
#pragma once

#include <rehearse/scenario.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {

inline const std::filesystem::path fixtures = FIXTURES_DIR;

using test::read_file;

/// A file path for the running test alone.
inline std::filesystem::path write_file(const std::string& name, const std::string& text) {
  static const test::TemporaryFolder temporary;
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = temporary.path() / test->name();
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

inline Result<Scenario> load_text(const std::string& text) { return Scenario::load(write_file("test.yaml", text)); }

/// All diagnostics, one per line; empty if the scenario was loaded.
inline std::string mistakes(const Result<Scenario>& result) { return result ? "" : to_string(result.errors()); }

/// The scenario of a text that must be valid.
inline Scenario loaded(const std::string& text) {
  Result<Scenario> result = load_text(text);
  EXPECT_TRUE(result.ok()) << mistakes(result);
  return result ? *std::move(result) : Scenario{};
}

/// A scenario of one second with one free ball, and more lines after it.
inline std::string ball_with(const std::string& lines) {
  return "rehearse: 1\nduration: 1\nbodies: [{name: Ball, sphere: {radius: 0.1}, mass: 1}]\n" + lines;
}

/// A scenario of one second with SR1, and more of its keys.
inline std::string sr1_with(const std::string& keys) {
  return "rehearse: 1\nduration: 1\nbodies:\n  - name: SR1\n    model: " + (fixtures / "models/sr1.urdf").string() +
         "\n" + keys;
}

}  // namespace rehearse
