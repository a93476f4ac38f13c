// Nodes that a host must survive.
#include <chrono>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/float64.hpp>
#include <stdexcept>

namespace test_nodes {

/// Throws at 0.1 s.
class Thrower : public rclcpp::Node {
 public:
  explicit Thrower(const rclcpp::NodeOptions& options) : Node("thrower", options) {
    timer_ = create_wall_timer(std::chrono::milliseconds(100), [] { throw std::runtime_error("no more"); });
  }

 private:
  rclcpp::TimerBase::SharedPtr timer_;
};

/// Answers its own messages.
class Talker : public rclcpp::Node {
 public:
  explicit Talker(const rclcpp::NodeOptions& options) : Node("talker", options) {
    publisher_ = create_publisher<std_msgs::msg::Float64>("~/echo", 1);
    subscription_ = create_subscription<std_msgs::msg::Float64>(
        "~/echo", 1, [this](const std_msgs::msg::Float64& message) { publisher_->publish(message); });
    publisher_->publish(std_msgs::msg::Float64());
  }

 private:
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr publisher_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr subscription_;
};

}  // namespace test_nodes

RCLCPP_COMPONENTS_REGISTER_NODE(test_nodes::Thrower)
RCLCPP_COMPONENTS_REGISTER_NODE(test_nodes::Talker)
