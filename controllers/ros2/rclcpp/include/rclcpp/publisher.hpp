// Publishers.
#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <rosidl_runtime_cpp/traits.hpp>

#include "rclcpp/detail/topic.hpp"
#include "rclcpp/logging.hpp"

namespace rclcpp {

enum class IntraProcessSetting { Enable, Disable, NodeDefault };

/// Callbacks about deadlines, liveliness and incompatible quality: accepted, and never called (see the page
/// "What a ROS 2 result means").
struct EventCallbacks {
  std::function<void(void)> deadline_callback, liveliness_callback, incompatible_qos_callback,
      incompatible_type_callback, message_lost_callback, matched_callback;
};

template <class Allocator = std::allocator<void>>
struct PublisherOptionsWithAllocator {
  IntraProcessSetting use_intra_process_comm = IntraProcessSetting::NodeDefault;
  EventCallbacks event_callbacks;
  bool use_default_callbacks = true;
  std::shared_ptr<CallbackGroup> callback_group;
};
using PublisherOptions = PublisherOptionsWithAllocator<>;

/// The types that a publisher takes and sends. Here they are one: there are no adapters.
template <class Custom, class Message = void, class Enable = void>
struct TypeAdapter {
  using is_specialized = std::false_type;
  using custom_type = Custom;
  using ros_message_type = Custom;
};

/// A message that a publisher lends. Here it is an ordinary message.
template <class Message>
class LoanedMessage {
 public:
  LoanedMessage() : message_(std::make_unique<Message>()) {}
  bool is_valid() const { return message_ != nullptr; }
  Message& get() const { return *message_; }
  std::unique_ptr<Message> release() { return std::move(message_); }

 private:
  std::unique_ptr<Message> message_;
};

class PublisherBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(PublisherBase)
  PublisherBase(const std::string& topic, const rehearse_ros2::MessageMembers& type, const QoS& qos)
      : endpoint_(std::make_shared<rehearse_ros2::Endpoint>(topic, type, qos)) {}
  virtual ~PublisherBase() = default;
  RCLCPP_DISABLE_COPY(PublisherBase)
  const char* get_topic_name() const { return endpoint_->topic.c_str(); }
  std::size_t get_queue_size() const { return endpoint_->qos.depth(); }
  QoS get_actual_qos() const { return endpoint_->qos; }
  std::size_t get_subscription_count() const;
  std::size_t get_intra_process_subscription_count() const { return 0; }
  bool assert_liveliness() const { return true; }
  bool can_loan_messages() const { return false; }
  template <class Count = std::int64_t, class Period = std::milli>
  bool wait_for_all_acked(std::chrono::duration<Count, Period> = std::chrono::duration<Count, Period>(-1)) const {
    return true;
  }
  const std::shared_ptr<rehearse_ros2::Endpoint>& rehearse_endpoint() const { return endpoint_; }
  void rehearse_publish(std::shared_ptr<const void> message);

 private:
  std::shared_ptr<rehearse_ros2::Endpoint> endpoint_;
};

template <class Message, class Allocator = std::allocator<void>>
class Publisher : public PublisherBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Publisher)
  using PublishedType = Message;
  using ROSMessageType = Message;
  using MessageUniquePtr = std::unique_ptr<Message>;
  using MessageSharedPtr = std::shared_ptr<const Message>;
  Publisher(const std::string& topic, const QoS& qos)
      : PublisherBase(topic, rehearse_ros2::members_of<Message>(), qos) {}
  void publish(const Message& message) { rehearse_publish(std::make_shared<const Message>(message)); }
  template <class Deleter>
  void publish(std::unique_ptr<Message, Deleter> message) {
    rehearse_publish(std::shared_ptr<const Message>(std::move(message)));
  }
  void publish(LoanedMessage<Message>&& message) { publish(message.release()); }
  LoanedMessage<Message> borrow_loaned_message() { return {}; }
};

}  // namespace rclcpp
