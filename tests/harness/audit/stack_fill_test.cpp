// The contents of a stack that was filled before a call.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/host/interposer.h"

namespace rehearse {
namespace {

/// A local variable without a value, as large as a controller's may be.
__attribute__((noinline, no_sanitize("address"))) std::vector<unsigned char> what_lies_below() {
  volatile unsigned char local[4096];
  std::vector<unsigned char> seen(sizeof local);
  for (std::size_t i = 0; i < sizeof local; ++i) seen[i] = local[i];
  return seen;
}

TEST(StackFill, ShowsInLocalVariablesWithoutAValue) {
  for (const unsigned char pattern : {0x5a, 0xa5}) {
    StackFill(pattern).paint();
    const std::vector<unsigned char> seen = what_lies_below();
    EXPECT_GT(std::ranges::count(seen, pattern), 3500);
  }
}

}  // namespace
}  // namespace rehearse
