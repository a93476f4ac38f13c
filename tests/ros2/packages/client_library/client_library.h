// A node and its executor, for tests of the documented behaviour of rclcpp, rclcpp_action and rclcpp_lifecycle. Time is
// real; timers run by ROS time, which go_to() moves.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int32.hpp>
#include <vector>

using namespace std::chrono_literals;
using std_msgs::msg::Int32;
using Numbers = std::vector<int>;

inline constexpr std::int64_t second = 1'000'000'000;  // [ns]

class ClientLibrary : public ::testing::Test {
 protected:
  static constexpr std::int64_t date = 1'700'000'000 * second;  // [ns] since 1970

  void SetUp() override {
    const char* const arguments[] = {"test", "--ros-args", "--log-level", "fatal"};
    rclcpp::init(4, arguments);
    rehearse_ros2::set_ros_time(date);
    node = std::make_shared<rclcpp::Node>("node");
    executor.emplace();
    executor->add_node(node);
  }
  void TearDown() override {
    executor.reset();
    node.reset();
    rclcpp::shutdown();
  }
  /// ROS time, after the beginning of the test [s].
  static void go_to(double seconds) { rehearse_ros2::set_ros_time(date + static_cast<std::int64_t>(seconds * 1e9)); }
  static Int32 number(int value) {
    Int32 message;
    message.data = value;
    return message;
  }
  rclcpp::Node::SharedPtr node;
  std::optional<rclcpp::executors::SingleThreadedExecutor> executor;
};
