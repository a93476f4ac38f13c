// Wait sets.
#pragma once

#include <chrono>
#include <initializer_list>
#include <memory>
#include <vector>

#include "rclcpp/node.hpp"

namespace rclcpp {

enum WaitResultKind { Ready, Timeout, Empty, Invalid };

template <class Set>
class WaitResult {
 public:
  WaitResult(WaitResultKind kind, Set& set) : kind_(kind), set_(&set) {}
  WaitResultKind kind() const { return kind_; }
  Set& get_wait_set() { return *set_; }
  const Set& get_wait_set() const { return *set_; }

 private:
  WaitResultKind kind_;
  Set* set_;
};

class WaitSet {
 public:
  WaitSet() = default;
  explicit WaitSet(const std::vector<SubscriptionBase::SharedPtr>& subscriptions) {
    for (const auto& subscription : subscriptions) add_subscription(subscription);
  }
  ~WaitSet();
  RCLCPP_DISABLE_COPY(WaitSet)
  /// Throw std::runtime_error if it is in another wait set.
  void add_subscription(SubscriptionBase::SharedPtr subscription) { add(std::move(subscription)); }
  void remove_subscription(SubscriptionBase::SharedPtr subscription) { remove(subscription); }
  void add_timer(TimerBase::SharedPtr timer) { add(std::move(timer)); }
  void remove_timer(TimerBase::SharedPtr timer) { remove(timer); }
  void add_client(ClientBase::SharedPtr client) { add(std::move(client)); }
  void remove_client(ClientBase::SharedPtr client) { remove(client); }
  void add_service(ServiceBase::SharedPtr service) { add(std::move(service)); }
  void remove_service(ServiceBase::SharedPtr service) { remove(service); }
  void add_waitable(Waitable::SharedPtr waitable) { add(std::move(waitable)); }
  void remove_waitable(Waitable::SharedPtr waitable) { remove(waitable); }
  void add_guard_condition(GuardCondition::SharedPtr condition) { conditions_.push_back(std::move(condition)); }
  void remove_guard_condition(GuardCondition::SharedPtr condition);
  template <class Count = std::int64_t, class Period = std::milli>
  WaitResult<WaitSet> wait(std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
    return {wait_nanoseconds(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout)), *this};
  }

 private:
  void add(std::shared_ptr<rehearse_ros2::Entity> entity);
  void remove(const std::shared_ptr<rehearse_ros2::Entity>& entity);
  WaitResultKind wait_nanoseconds(std::chrono::nanoseconds timeout);
  std::vector<std::shared_ptr<rehearse_ros2::Entity>> entities_;
  std::vector<GuardCondition::SharedPtr> conditions_;
};

/// False: none came in this time.
template <class Message, class Count = std::int64_t, class Period = std::milli>
bool wait_for_message(Message& message, std::shared_ptr<Subscription<Message>> subscription,
                      Context::SharedPtr = nullptr,
                      std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
  WaitSet set;
  set.add_subscription(subscription);
  MessageInfo info;
  return set.wait(timeout).kind() == Ready && subscription->take(message, info);
}
template <class Message, class Count = std::int64_t, class Period = std::milli>
bool wait_for_message(Message& message, std::shared_ptr<Node> node, const std::string& topic,
                      std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
  const auto subscription =
      node->create_subscription<Message>(topic, QoS(1), [](const std::shared_ptr<const Message>) {});
  return wait_for_message(message, subscription, nullptr, timeout);
}

}  // namespace rclcpp
