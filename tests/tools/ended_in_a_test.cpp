// A user's test program that its controller ends: run by failing_controllers_test.cpp, not by ctest.
#include <rehearse/session.h>

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

void record_scenario(const char* name) {
  const auto scenario = rehearse::Scenario::load("pendulum.yaml");
  ASSERT_TRUE(scenario.ok());
  EXPECT_TRUE(rehearse::record(*scenario, name).ok());
}

TEST(Walk, Before) {
  EXPECT_EXIT(std::exit(0), testing::ExitedWithCode(0), "") << "a child that ends announces nothing for this process";
}
TEST(Walk, Ended) { record_scenario("ended.mcap"); }
TEST(Walk, After) {}
TEST(Walk, Last) { record_scenario("last.mcap"); }

}  // namespace
