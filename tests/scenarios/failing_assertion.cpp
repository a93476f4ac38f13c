// A user's test of a run that differs from its golden. golden_assertions_test.cpp runs it to read its report.
#include <rehearse/gtest.h>

TEST(Box, Falls) {
  EXPECT_MATCHES_GOLDEN(rehearse::record("fall.yaml"), rehearse::Near{"Box/Box/orientation/*", 1e-6},
                        rehearse::Until{0.04});
}

TEST(Misread, NamesASeriesThatTheRunLacks) {
  const rehearse::Trace trace = rehearse::record("fall.yaml");
  EXPECT_GT(trace.last("Box/Box/positon/z"), 0.0);
}

TEST(Misread, NamesAScenarioThatIsMissing) { rehearse::record("missing.yaml"); }

TEST(Misread, NamesAModelThatIsMissing) { rehearse::ControllerBench bench("Hold", "missing.urdf"); }
