// Subscriptions.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "rclcpp/publisher.hpp"

namespace rclcpp {

struct ContentFilterOptions {
  std::string filter_expression;
  std::vector<std::string> expression_parameters;
};

template <class Allocator = std::allocator<void>>
struct SubscriptionOptionsWithAllocator {
  EventCallbacks event_callbacks;
  bool use_default_callbacks = true;
  bool ignore_local_publications = false;
  std::shared_ptr<CallbackGroup> callback_group;
  IntraProcessSetting use_intra_process_comm = IntraProcessSetting::NodeDefault;
  ContentFilterOptions content_filter_options;
};
using SubscriptionOptions = SubscriptionOptionsWithAllocator<>;

class SubscriptionBase : public rehearse_ros2::Entity {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(SubscriptionBase)
  SubscriptionBase(const std::string& topic, const rehearse_ros2::MessageMembers& type, const QoS& qos)
      : endpoint_(std::make_shared<rehearse_ros2::Endpoint>(topic, type, qos)) {}
  const char* get_topic_name() const { return endpoint_->topic.c_str(); }
  QoS get_actual_qos() const { return endpoint_->qos; }
  std::size_t get_publisher_count() const;
  bool is_serialized() const { return false; }
  bool rehearse_ready(std::int64_t) override { return !endpoint_->queue.empty(); }
  const std::shared_ptr<rehearse_ros2::Endpoint>& rehearse_endpoint() const { return endpoint_; }

 protected:
  bool take_delivery(rehearse_ros2::Delivery& delivery);

 private:
  std::shared_ptr<rehearse_ros2::Endpoint> endpoint_;
};

namespace detail {

/// A callback of any of the forms that rclcpp allows, called with a message that others may hold, too.
template <class Message, class Callback>
void call_with_message(Callback& callback, const std::shared_ptr<const Message>& message, const MessageInfo& info) {
  using Shared = std::shared_ptr<Message>;
  using SharedConst = std::shared_ptr<const Message>;
  using Unique = std::unique_ptr<Message>;
  const auto copy = [&] { return std::make_unique<Message>(*message); };
  if constexpr (std::is_invocable_v<Callback&, const Message&, const MessageInfo&>)
    callback(*message, info);
  else if constexpr (std::is_invocable_v<Callback&, SharedConst, const MessageInfo&>)
    callback(message, info);
  else if constexpr (std::is_invocable_v<Callback&, Shared, const MessageInfo&>)
    callback(Shared(copy()), info);
  else if constexpr (std::is_invocable_v<Callback&, Unique, const MessageInfo&>)
    callback(copy(), info);
  else if constexpr (std::is_invocable_v<Callback&, const Message&>)
    callback(*message);
  else if constexpr (std::is_invocable_v<Callback&, SharedConst>)
    callback(message);
  else if constexpr (std::is_invocable_v<Callback&, Shared>)
    callback(Shared(copy()));
  else {
    static_assert(std::is_invocable_v<Callback&, Unique>, "the callback takes no message of this topic");
    callback(copy());
  }
}

}  // namespace detail

template <class Message, class Allocator = std::allocator<void>>
class Subscription : public SubscriptionBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Subscription)
  using SubscribedType = Message;
  using ROSMessageType = Message;
  template <class Callback>
  Subscription(const std::string& topic, const QoS& qos, Callback callback)
      : SubscriptionBase(topic, rehearse_ros2::members_of<Message>(), qos),
        call_([callback = std::move(callback)](const std::shared_ptr<const Message>& message,
                                               const MessageInfo& info) mutable {
          detail::call_with_message<Message>(callback, message, info);
        }) {}
  /// False: there is none.
  bool take(Message& message, MessageInfo& info) {
    rehearse_ros2::Delivery delivery;
    if (!take_delivery(delivery)) return false;
    message = *static_cast<const Message*>(delivery.message.get());
    info = delivery.info;
    return true;
  }
  void rehearse_execute() override {
    rehearse_ros2::Delivery delivery;
    if (take_delivery(delivery)) call_(std::static_pointer_cast<const Message>(delivery.message), delivery.info);
  }

 private:
  std::function<void(const std::shared_ptr<const Message>&, const MessageInfo&)> call_;
};

}  // namespace rclcpp
