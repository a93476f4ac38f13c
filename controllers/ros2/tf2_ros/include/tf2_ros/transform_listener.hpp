// Puts the transforms of /tf and /tf_static into a buffer.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "tf2_ros/buffer.hpp"
#include "tf2_ros/transform_broadcaster.hpp"

namespace tf2_ros {

class TransformListener {
 public:
  explicit TransformListener(tf2::BufferCore& buffer, bool spin_thread = true)
      : TransformListener(buffer,
                          std::make_shared<rclcpp::Node>("transform_listener_" +
                                                         std::to_string(rehearse_ros2::Bus::instance().next_number())),
                          spin_thread) {}
  template <class NodeType>
  TransformListener(tf2::BufferCore& buffer, NodeType&& node, bool spin_thread = true,
                    const rclcpp::QoS& qos = DynamicListenerQoS(), const rclcpp::QoS& static_qos = StaticListenerQoS())
      : buffer_(buffer), base_(rclcpp::node_interfaces::get_node_base_interface(node)) {
    rclcpp::SubscriptionOptions options;
    options.callback_group = base_->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, !spin_thread);
    const auto topics = rclcpp::node_interfaces::get_node_topics_interface(node);
    const auto listen = [&](const char* topic, const rclcpp::QoS& of_topic, bool is_static) {
      return rclcpp::create_subscription<tf2_msgs::msg::TFMessage>(
          topics, topic, of_topic,
          [this, is_static](tf2_msgs::msg::TFMessage::ConstSharedPtr message) { take(*message, is_static); }, options);
    };
    moving_ = listen("/tf", qos, false);
    static_ = listen("/tf_static", static_qos, true);
    group_ = options.callback_group;
    if (!spin_thread) return;
    executor_ = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
    executor_->add_callback_group(group_, base_);
    thread_ = std::thread([this] {
      while (!ends_ && rclcpp::ok()) executor_->spin_once(std::chrono::milliseconds(100));
    });
    buffer.setUsingDedicatedThread(true);
  }
  ~TransformListener() {
    ends_ = true;
    if (!executor_) return;
    executor_->cancel();
    thread_.join();
  }
  TransformListener(const TransformListener&) = delete;
  TransformListener& operator=(const TransformListener&) = delete;

 private:
  void take(const tf2_msgs::msg::TFMessage& message, bool is_static) {
    for (const auto& transform : message.transforms) {
      try {
        buffer_.setTransform(transform, "bus", is_static);
      } catch (const std::exception& problem) {
        RCLCPP_ERROR(rclcpp::get_logger("tf2_ros"), "a transform can't be used: %s", problem.what());
      }
    }
  }

  tf2::BufferCore& buffer_;
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base_;
  rclcpp::CallbackGroup::SharedPtr group_;
  rclcpp::Subscription<tf2_msgs::msg::TFMessage>::SharedPtr moving_, static_;
  std::atomic<bool> ends_{false};
  std::unique_ptr<rclcpp::executors::SingleThreadedExecutor> executor_;
  std::thread thread_;
};

}  // namespace tf2_ros
