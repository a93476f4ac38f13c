// Nodes with states, by the article "Managed nodes" of ROS 2's design.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lifecycle_msgs/msg/state.hpp>
#include <lifecycle_msgs/msg/transition.hpp>
#include <lifecycle_msgs/msg/transition_event.hpp>
#include <rclcpp/rclcpp.hpp>

namespace rclcpp_lifecycle {

class State {
 public:
  explicit State(std::uint8_t id = lifecycle_msgs::msg::State::PRIMARY_STATE_UNKNOWN,
                 const std::string& label = "unknown")
      : id_(id), label_(label) {}
  virtual ~State() = default;
  std::uint8_t id() const { return id_; }
  std::string label() const { return label_; }

 private:
  std::uint8_t id_;
  std::string label_;
};

class Transition {
 public:
  explicit Transition(std::uint8_t id, const std::string& label = "") : id_(id), label_(label) {}
  Transition(std::uint8_t id, const std::string& label, State start, State goal)
      : id_(id), label_(label), start_(std::move(start)), goal_(std::move(goal)) {}
  virtual ~Transition() = default;
  std::uint8_t id() const { return id_; }
  std::string label() const { return label_; }
  State start_state() const { return start_; }
  State goal_state() const { return goal_; }

 private:
  std::uint8_t id_;
  std::string label_;
  State start_, goal_;
};

/// What is on while its node is active.
class ManagedEntityInterface {
 public:
  virtual ~ManagedEntityInterface() = default;
  virtual void on_activate() = 0;
  virtual void on_deactivate() = 0;
};
class SimpleManagedEntity : public ManagedEntityInterface {
 public:
  void on_activate() override { is_activated_ = true; }
  void on_deactivate() override { is_activated_ = false; }
  bool is_activated() const { return is_activated_; }

 private:
  std::atomic<bool> is_activated_{false};
};

/// publish() of the base isn't virtual: a call by a pointer to rclcpp::Publisher publishes in any state.
template <class Message, class Allocator = std::allocator<void>>
class LifecyclePublisher : public SimpleManagedEntity, public rclcpp::Publisher<Message, Allocator> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(LifecyclePublisher)
  using Base = rclcpp::Publisher<Message, Allocator>;
  using MessageUniquePtr = typename Base::MessageUniquePtr;
  using MessageSharedPtr = typename Base::MessageSharedPtr;
  LifecyclePublisher(const std::string& topic, const rclcpp::QoS& qos) : Base(topic, qos) {}
  virtual void publish(MessageUniquePtr message) {
    if (may_publish()) Base::publish(std::move(message));
  }
  virtual void publish(const Message& message) {
    if (may_publish()) Base::publish(message);
  }
  virtual void publish(rclcpp::LoanedMessage<Message>&& message) {
    if (may_publish()) Base::publish(std::move(message));
  }
  void on_activate() override {
    SimpleManagedEntity::on_activate();
    is_told_ = false;
  }

 private:
  bool may_publish() {
    if (is_activated()) return true;
    if (!std::exchange(is_told_, true))
      RCLCPP_WARN(rclcpp::get_logger("LifecyclePublisher"),
                  "Trying to publish message on the topic '%s', but the publisher is not activated",
                  this->get_topic_name());
    return false;
  }
  bool is_told_ = false;
};

namespace node_interfaces {

class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t {
    SUCCESS = lifecycle_msgs::msg::Transition::TRANSITION_CALLBACK_SUCCESS,
    FAILURE = lifecycle_msgs::msg::Transition::TRANSITION_CALLBACK_FAILURE,
    ERROR = lifecycle_msgs::msg::Transition::TRANSITION_CALLBACK_ERROR
  };
  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const State&) { return CallbackReturn::FAILURE; }
};

}  // namespace node_interfaces

class LifecycleNode : public rclcpp::RehearseNode,
                      public node_interfaces::LifecycleNodeInterface,
                      public std::enable_shared_from_this<LifecycleNode> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(LifecycleNode)
  using LifecycleCallback = std::function<CallbackReturn(const State&)>;
  explicit LifecycleNode(const std::string& name, const rclcpp::NodeOptions& options = rclcpp::NodeOptions(),
                         bool enable_communication_interface = true)
      : LifecycleNode(name, "", options, enable_communication_interface) {}
  LifecycleNode(const std::string& name, const std::string& space,
                const rclcpp::NodeOptions& options = rclcpp::NodeOptions(), bool enable_communication_interface = true);
  virtual ~LifecycleNode();

  template <class Message, class Allocator = std::allocator<void>>
  std::shared_ptr<LifecyclePublisher<Message, Allocator>> create_publisher(
      const std::string& topic, const rclcpp::QoS& qos,
      const rclcpp::PublisherOptions& options = rclcpp::PublisherOptions()) {
    auto publisher = rclcpp::create_publisher<Message, Allocator, LifecyclePublisher<Message, Allocator>>(
        get_node_topics_interface(), topic, qos, options);
    add_managed_entity(publisher);
    return publisher;
  }

  const State& get_current_state() const { return state_; }
  std::vector<State> get_available_states() const;
  /// Those that begin in the current state.
  std::vector<Transition> get_available_transitions() const;
  std::vector<Transition> get_transition_graph() const;
  /// A transition that doesn't begin in the current state is refused: the state stays, the result is ERROR.
  const State& trigger_transition(std::uint8_t id, CallbackReturn& result);
  const State& trigger_transition(std::uint8_t id) {
    CallbackReturn ignored;
    return trigger_transition(id, ignored);
  }
  const State& trigger_transition(const Transition& transition) { return trigger_transition(transition.id()); }
  const State& trigger_transition(const Transition& transition, CallbackReturn& result) {
    return trigger_transition(transition.id(), result);
  }

#define REHEARSE_TRANSITION(name)                       \
  const State& name();                                  \
  const State& name(CallbackReturn& result);            \
  bool register_on_##name(LifecycleCallback callback) { \
    name##_ = std::move(callback);                      \
    return true;                                        \
  }
  REHEARSE_TRANSITION(configure)
  REHEARSE_TRANSITION(cleanup)
  REHEARSE_TRANSITION(activate)
  REHEARSE_TRANSITION(deactivate)
  REHEARSE_TRANSITION(shutdown)
#undef REHEARSE_TRANSITION
  bool register_on_error(LifecycleCallback callback) {
    error_ = std::move(callback);
    return true;
  }
  CallbackReturn on_activate(const State& previous) override;
  CallbackReturn on_deactivate(const State& previous) override;
  void add_managed_entity(std::weak_ptr<ManagedEntityInterface> entity) { entities_.push_back(std::move(entity)); }

 private:
  CallbackReturn call(const LifecycleCallback& callback, const State& previous);
  void go_to(std::uint8_t state, const Transition& transition);

  State state_;
  LifecycleCallback configure_, cleanup_, activate_, deactivate_, shutdown_, error_;
  std::vector<std::weak_ptr<ManagedEntityInterface>> entities_;
  rclcpp::Publisher<lifecycle_msgs::msg::TransitionEvent>::SharedPtr events_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
};

}  // namespace rclcpp_lifecycle
