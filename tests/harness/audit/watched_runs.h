// Runs a function of libraries/watched.cpp in a process with the interposer, and reads the recorded calls.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "audit/audit/call_log.h"
#include "core/host/interposer.h"
#include "support/shell.h"
#include "support/temporary_folder.h"

namespace rehearse {

inline std::string watched_library(const std::string& name = "watched") {
  return AUDIT_LIBRARIES "/lib" + name + ".so";
}

struct WatchedRun {
  std::vector<double> values;  // returned, by tick
  CallLog log;

  /// The calls of a function.
  std::vector<ObservedCall> calls_of(const std::string& function) const {
    std::vector<ObservedCall> found;
    for (const ObservedCall& call : log.calls)
      if (call.function == function) found.push_back(call);
    return found;
  }
  /// The only call of a function; a test failure if there are several.
  ObservedCall call_of(const std::string& function) const {
    const auto found = calls_of(function);
    EXPECT_EQ(found.size(), 1u) << function;
    return found.empty() ? ObservedCall{} : found[0];
  }
};

class WatchedTest : public ::testing::Test {
 protected:
  WatchedTest() {
    std::filesystem::create_directories(folder_);
    setenv("LC_ALL", "C.UTF-8", 1);
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  /// Options for simulated time and seeded random numbers.
  static Substitution substituted(std::uint64_t seed = 1) {
    Substitution substitution;
    substitution.clock = SimulatedClock{};
    substitution.seed = seed;
    return substitution;
  }

  WatchedRun run(const std::string& function, int ticks = 5, const Substitution& everywhere = {}) {
    InterposerSettings settings;
    settings.everywhere = everywhere;
    return run(function, ticks, settings);
  }

  WatchedRun run(const std::string& function, int ticks, InterposerSettings settings) {
    WatchedRun result;
    settings.log = folder_ / "calls.log";
    std::filesystem::remove(settings.log);
    std::ifstream output(start(function, ticks, settings));
    for (std::string line; std::getline(output, line);) result.values.push_back(std::strtod(line.c_str(), nullptr));
    auto log = read_call_log(settings.log);
    EXPECT_TRUE(log.ok()) << to_string(log.errors());
    if (log) result.log = *log;
    return result;
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_ / "for a shell;";
  std::string library_ = watched_library();
  int status_ = 0;  // of the last process

 private:
  /// Runs it in the folder; the file with its output.
  std::filesystem::path start(const std::string& function, int ticks, const InterposerSettings& settings) {
    const auto changes = interposer_environment(settings);
    EXPECT_TRUE(changes.ok()) << to_string(changes.errors());
    // the shell's messages about a crashed process go to the same file
    std::string command =
        "exec 2> " + test::quoted((folder_ / "errors").string()) + "; cd " + test::quoted(folder_.string()) + " && env";
    for (const auto& [name, value] : *changes) command += " " + test::quoted(name + "=" + value.value_or(""));
    command += " " WATCHED_PROCESS " " + library_ + " " + function + " " + std::to_string(ticks) + " > output";
    status_ = std::system(command.c_str());
    return folder_ / "output";
  }
};

}  // namespace rehearse
