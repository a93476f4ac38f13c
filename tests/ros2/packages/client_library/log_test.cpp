// Lines of logs.
#include "client_library.h"

namespace {

TEST_F(ClientLibrary, AThrottledLineWaitsForItsClock) {
  int count = 0;
  const auto line = [&] {
    RCLCPP_INFO_STREAM_THROTTLE(node->get_logger(), *node->get_clock(), 10000, "line " << ++count);
  };
  node->get_logger().set_level(rclcpp::Logger::Level::Info);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  line();
  line();
  EXPECT_EQ(count, 1);
  go_to(11.0);
  line();
  EXPECT_EQ(count, 2);
  testing::internal::GetCapturedStdout();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("[node]"), std::string::npos);
}

}  // namespace
