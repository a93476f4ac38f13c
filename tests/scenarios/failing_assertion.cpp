// A user's test of a run that differs from its golden. golden_assertions_test.cpp runs it to read its report.
#include <rehearse/gtest.h>

TEST(Box, Falls) {
  EXPECT_MATCHES_GOLDEN(rehearse::record("fall.yaml"), rehearse::Near{"Box/Box/orientation/*", 1e-6},
                        rehearse::Until{0.04});
}
