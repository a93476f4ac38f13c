// EXPECT_SAME_IN_ALL_ORDERS.
#include <gmock/gmock.h>
#include <rehearse/gtest.h>

#include <string>

#include "session/runs.h"
#include "support/environment_variable.h"

namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class OrdersAssertions : public rehearse::RunTest {
 protected:
  OrdersAssertions() {
    rehearse::set_test_folders({path("").string(), path("golden").string(), path("").string(), ""});
  }

  /// Makes a golden of a controller of Threads.so, and tries 20 orders.
  rehearse::internal::TestVerdict try_orders_of(const std::string& controller) const {
    write("run.yaml", rig(controller));
    {
      const rehearse::test::EnvironmentVariable no_ci("CI", nullptr), mode("REHEARSE_GOLDEN", "new");
      const auto made = rehearse::internal::match_golden(rehearse::record("run.yaml"), "Rig.Turns");
      EXPECT_TRUE(made.passed) << made.message;
    }
    return rehearse::internal::try_orders_of_golden("Rig.Turns", 20, "Rig.HasOneResult");
  }
  static std::string threads(const std::string& guest) { return "{name: C, library: Threads, options: " + guest + "}"; }
};

TEST_F(OrdersAssertions, PassIfNoOrderChangesACommand) {
  const auto verdict = try_orders_of(threads("planner"));
  EXPECT_TRUE(verdict.passed) << verdict.message;
  EXPECT_THAT(verdict.message, HasSubstr("gave the same 20 commands, bit for bit, in 20 other orders of 2 threads"));
}

TEST_F(OrdersAssertions, FailWithTheThreadsThatExchangeTheirTurns) {
  const auto verdict = try_orders_of(threads("contended"));
  EXPECT_FALSE(verdict.passed);
  EXPECT_THAT(verdict.message, MatchesRegex("Rig/C depends on the order of threads: SHOULDER/u of /Rig/C/output/joints "
                                            "differs from tick [0-9]+ on if .* runs before .*\n"
                                            "  it is repeated by: rehearse replay .*Rig.Turns.mcap --order "
                                            ".*/traces/Rig.HasOneResult.order.json\n(.|\n)*"));
  EXPECT_TRUE(exists(path("traces/Rig.HasOneResult.order.json")));
}

TEST_F(OrdersAssertions, FailIfNothingCanBeCompared) {
  const auto verdict = try_orders_of(behaviour("C", "allocate 2"));
  EXPECT_FALSE(verdict.passed);
  EXPECT_EQ(verdict.message.substr(0, verdict.message.find('\n')),
            "nothing was compared: there is no other order to try: at no place are several threads of Rig/C ready that "
            "take turns");
  EXPECT_THAT(rehearse::internal::try_orders_of_golden("Rig.Turn", 20, "Rig.HasOneResult").message,
              HasSubstr("there is no golden"));
}

}  // namespace
