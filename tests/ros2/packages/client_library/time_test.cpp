// Times, durations, clocks and rates.
#include <limits>

#include "client_library.h"

namespace {

TEST_F(ClientLibrary, TimesOfTwoKindsOfClocksAreNotCompared) {
  const rclcpp::Time ros = node->now(), steady = rclcpp::Clock(RCL_STEADY_TIME).now();
  EXPECT_THROW((void)(ros < steady), std::runtime_error);
  EXPECT_THROW((void)(ros - steady), std::runtime_error);
  EXPECT_EQ(rclcpp::Time(std::int64_t{5}).get_clock_type(), RCL_SYSTEM_TIME);
  EXPECT_EQ(rclcpp::Time(builtin_interfaces::msg::Time()).get_clock_type(), RCL_ROS_TIME);
}

TEST_F(ClientLibrary, TheEpochsOfClocksDiffer) {
  EXPECT_GT(std::abs(node->now().nanoseconds() - rclcpp::Clock(RCL_STEADY_TIME).now().nanoseconds()), 3600 * second);
}

TEST_F(ClientLibrary, SumsThatDoNotFitThrow) {
  EXPECT_THROW(rclcpp::Time::max() + rclcpp::Duration(0, 1), std::overflow_error);
  EXPECT_THROW(rclcpp::Duration::from_nanoseconds(std::numeric_limits<std::int64_t>::min()) - rclcpp::Duration(0, 1),
               std::underflow_error);
  EXPECT_THROW(rclcpp::Duration::max() * 2.0, std::overflow_error);
  EXPECT_EQ(rclcpp::Duration::from_seconds(-0.5).nanoseconds(), -second / 2);
  const builtin_interfaces::msg::Duration message = rclcpp::Duration::from_seconds(-0.5);
  EXPECT_EQ(message.sec, -1);
  EXPECT_EQ(message.nanosec, 500'000'000u);
}

TEST_F(ClientLibrary, ARateThatIsNotPositiveIsRefused) {
  for (const double frequency : {0.0, -1.0}) {
    try {
      const rclcpp::Rate rate(frequency);
      ADD_FAILURE() << frequency;
    } catch (const std::invalid_argument& problem) {
      EXPECT_STREQ(problem.what(), "rate must be greater than 0");
    }
  }
}

TEST_F(ClientLibrary, ALateRateDoesNotSleep) {
  rclcpp::Rate rate(rclcpp::Duration(10, 0), node->get_clock());
  go_to(15.0);
  EXPECT_FALSE(rate.sleep());
}

}  // namespace
