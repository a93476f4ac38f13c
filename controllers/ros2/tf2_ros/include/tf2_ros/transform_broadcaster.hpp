// Publishes transforms on /tf, and those that never change on /tf_static.
#pragma once

#include <algorithm>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vector>

namespace tf2_ros {

inline rclcpp::QoS DynamicBroadcasterQoS(std::size_t depth = 100) { return rclcpp::QoS(depth); }
inline rclcpp::QoS StaticBroadcasterQoS(std::size_t depth = 1) { return rclcpp::QoS(depth).transient_local(); }
inline rclcpp::QoS DynamicListenerQoS(std::size_t depth = 100) { return rclcpp::QoS(depth); }
inline rclcpp::QoS StaticListenerQoS(std::size_t depth = 100) { return rclcpp::QoS(depth).transient_local(); }

class TransformBroadcaster {
 public:
  template <class NodeType>
  explicit TransformBroadcaster(NodeType&& node, const rclcpp::QoS& qos = DynamicBroadcasterQoS())
      : publisher_(rclcpp::create_publisher<tf2_msgs::msg::TFMessage>(
            rclcpp::node_interfaces::get_node_topics_interface(node), "/tf", qos)) {}
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform) {
    sendTransform(std::vector<geometry_msgs::msg::TransformStamped>{transform});
  }
  void sendTransform(const std::vector<geometry_msgs::msg::TransformStamped>& transforms) {
    tf2_msgs::msg::TFMessage message;
    message.transforms = transforms;
    publisher_->publish(message);
  }

 private:
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr publisher_;
};

/// Each message has all transforms so far; the last one of a frame counts.
class StaticTransformBroadcaster {
 public:
  template <class NodeType>
  explicit StaticTransformBroadcaster(NodeType&& node, const rclcpp::QoS& qos = StaticBroadcasterQoS())
      : publisher_(rclcpp::create_publisher<tf2_msgs::msg::TFMessage>(
            rclcpp::node_interfaces::get_node_topics_interface(node), "/tf_static", qos)) {}
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform) {
    sendTransform(std::vector<geometry_msgs::msg::TransformStamped>{transform});
  }
  void sendTransform(const std::vector<geometry_msgs::msg::TransformStamped>& transforms) {
    for (const auto& transform : transforms) {
      auto& known = message_.transforms;
      const auto place = std::find_if(known.begin(), known.end(), [&](const auto& other) {
        return other.child_frame_id == transform.child_frame_id;
      });
      if (place == known.end())
        known.push_back(transform);
      else
        *place = transform;
    }
    publisher_->publish(message_);
  }

 private:
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr publisher_;
  tf2_msgs::msg::TFMessage message_;
};

}  // namespace tf2_ros
