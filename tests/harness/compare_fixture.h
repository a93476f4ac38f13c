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
  Comparison compared(const std::vector<ToleranceRule>& rules = {}, const CompareOptions& options = {}) {
    return compare(golden_.load(folder_ / "golden.mcap"), actual_.load(folder_ / "actual.mcap"), rules, options);
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
