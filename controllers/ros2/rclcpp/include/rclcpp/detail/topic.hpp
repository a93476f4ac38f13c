// Topics of the process: who publishes and who listens.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/detail/message_type.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

class MessageInfo {
 public:
  MessageInfo() = default;
  explicit MessageInfo(const rmw_message_info_t& info) : info_(info) {}
  const rmw_message_info_t& get_rmw_message_info() const { return info_; }
  rmw_message_info_t& get_rmw_message_info() { return info_; }

 private:
  rmw_message_info_t info_{};
};

}  // namespace rclcpp

namespace rehearse_ros2 {

/// A message on its way. Receivers share it, and copy it if they change it.
struct Delivery {
  std::shared_ptr<const void> message;
  rclcpp::MessageInfo info;
};

/// The queue of a publisher for those who come later, or of a subscription.
class Endpoint {
 public:
  Endpoint(std::string topic, const MessageMembers& type, const rclcpp::QoS& qos)
      : topic(std::move(topic)), type(type), qos(qos) {}
  const std::string topic;
  const MessageMembers& type;
  const rclcpp::QoS qos;
  std::string node;            // the full name of its node; set before others see it
  std::deque<Delivery> queue;  // under the lock of the bus
  /// The oldest one goes if the queue is full.
  void put(const Delivery& delivery);
  bool take(Delivery& delivery);
};

struct Topic {
  const MessageMembers* type = nullptr;  // of the first who named it
  std::vector<std::weak_ptr<Endpoint>> publishers, subscriptions;
};

/// Called for each message that is published: a host records it.
using Tap = std::function<void(const Endpoint& publisher, const void* message)>;

/// All under the lock of the bus.
class Topics {
 public:
  static Topics& instance();
  /// Throws rclcpp::exceptions::InvalidTopicNameError if the topic has another type.
  void add_publisher(const std::shared_ptr<Endpoint>& publisher);
  /// Gives it what publishers keep for those who come later.
  void add_subscription(const std::shared_ptr<Endpoint>& subscription);
  void publish(Endpoint& publisher, std::shared_ptr<const void> message);
  std::size_t count_publishers(const std::string& topic);
  std::size_t count_subscriptions(const std::string& topic);
  std::vector<std::shared_ptr<Endpoint>> publishers_of(const std::string& topic);
  std::vector<std::shared_ptr<Endpoint>> subscriptions_of(const std::string& topic);
  /// The type of a topic that somebody publishes or listens to; null: nobody does.
  const MessageMembers* type_of(const std::string& topic);
  std::map<std::string, std::string> names_and_types();
  void set_tap(Tap tap) { tap_ = std::move(tap); }

 private:
  Topic& of(const Endpoint& endpoint);
  std::map<std::string, Topic> topics_;
  Tap tap_;
};

}  // namespace rehearse_ros2
