// A golden of three ticks and a run that starts as its copy, for tests that change one thing in either.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/compare.h>

#include <string>
#include <utility>
#include <vector>

#include "small_traces.h"

namespace rehearse::testing {

class Compare : public ::testing::Test {
 protected:
  /// Of the traces in memory; of the files, window by window, it has to be the same.
  Comparison compared(const std::vector<ToleranceRule>& rules = {}, const CompareOptions& options = {}) {
    const std::filesystem::path golden = folder_ / "golden.mcap", actual = folder_ / "actual.mcap";
    Comparison whole = compare(golden_.load(golden), actual_.load(actual), rules, options);
    CompareOptions silent = options;
    silent.on_difference = nullptr;
    for (const std::size_t window_size : {std::size_t{1}, std::size_t{300}, Trace::usual_piece_size}) {
      const auto in_windows = compare(golden, actual, rules, silent, window_size);
      EXPECT_TRUE(in_windows) << to_string(in_windows.errors());
      if (!in_windows) continue;
      EXPECT_EQ(to_json(*in_windows), to_json(whole)) << "in windows of " << window_size << " bytes";
    }
    return whole;
  }
  static ToleranceRule rule(std::string channel) {
    ToleranceRule made;
    made.channel = std::move(channel);
    return made;
  }
  void lengthen(std::int64_t ticks) {
    golden_.lengthen(ticks);
    actual_.lengthen(ticks);
  }

  TemporaryFolder folder_;
  SmallTrace golden_;
  SmallTrace actual_;
};

}  // namespace rehearse::testing
