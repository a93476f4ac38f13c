// Smooths the angle that the node `hold` publishes, in a thread of its own.
#include <atomic>
#include <chrono>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/float64.hpp>
#include <thread>

namespace test_nodes {

class Filter : public rclcpp::Node {
 public:
  explicit Filter(const rclcpp::NodeOptions& options) : Node("filter", options) {
    smooth_ = create_publisher<std_msgs::msg::Float64>("/smooth", 10);
    group_ = create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, false);
    rclcpp::SubscriptionOptions in_group;
    in_group.callback_group = group_;
    angles_ = create_subscription<std_msgs::msg::Float64>(
        "/hold/angle", 10,
        [this](const std_msgs::msg::Float64& message) {
          value_ += 0.1 * (message.data - value_);
          std_msgs::msg::Float64 smooth;
          smooth.data = value_;
          smooth_->publish(smooth);
        },
        in_group);
    executor_.add_callback_group(group_, get_node_base_interface());
    thread_ = std::thread([this] {
      while (!ends_) executor_.spin_once(std::chrono::milliseconds(50));
    });
  }
  ~Filter() override {
    ends_ = true;
    executor_.cancel();
    thread_.join();
  }

 private:
  double value_ = 0.0;
  std::atomic<bool> ends_{false};
  rclcpp::CallbackGroup::SharedPtr group_;
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr smooth_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr angles_;
  rclcpp::executors::SingleThreadedExecutor executor_;
  std::thread thread_;
};

}  // namespace test_nodes

RCLCPP_COMPONENTS_REGISTER_NODE(test_nodes::Filter)
