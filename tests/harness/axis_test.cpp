// The ranges of parameters in cells and pictures of a campaign's page.
#include "campaigns/statistics/axis.h"

#include <gtest/gtest.h>

#include <limits>

namespace rehearse {
namespace {

TEST(Axis, HasTheRangeOfItsFiniteValues) {
  const Axis axis({3.0, std::numeric_limits<double>::quiet_NaN(), -1.0, 7.0});
  EXPECT_EQ(axis.low(), -1.0);
  EXPECT_EQ(axis.high(), 7.0);
  EXPECT_EQ(axis.share(1.0), 0.25);
  EXPECT_EQ(axis.at(0.25), 1.0);
  EXPECT_EQ(Axis({2.0, 2.0}).share(2.0), 0.5);
}

TEST(Axis, IsDividedByRatiosIfItIsLogarithmic) {
  const Axis axis({1.0, 10'000.0}, true);
  EXPECT_NEAR(axis.share(10.0), 0.25, 1e-12);
  EXPECT_NEAR(axis.at(0.75), 1000.0, 1e-9);
}

TEST(Cells, OfLogUniformHaveEqualRatios) {
  CaseTable table;
  table.values = {{1.0, 20.0, 10'000.0}, {0.0, 1.0, 2.0}};
  table.words = {{}, {}};
  table.logarithmic = {true, false};
  table.verdicts.assign(3, CaseVerdict::passed);
  EXPECT_EQ(cell_text(table, 0, 0), "1 to 10");
  EXPECT_EQ(cell_text(table, 0, 3), "1000 to 1e+04");
  EXPECT_EQ(cell_text(table, 1, 0), "0 to 0.5");
  const CellGrid grid(table, 0, 1);
  ASSERT_EQ(grid.counts.size(), 16u);
  EXPECT_EQ(grid.counts[0 * 4 + 0], 1u);
  EXPECT_EQ(grid.counts[2 * 4 + 1], 1u) << "20 is between 10 and 100";
  EXPECT_EQ(grid.counts[3 * 4 + 3], 1u);
}

}  // namespace
}  // namespace rehearse
