// Nodes.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rclcpp/node_interfaces.hpp"
#include "rclcpp/node_options.hpp"

namespace rehearse_ros2 {

class NodeParts;
/// The object behind all interfaces of a new node.
std::shared_ptr<NodeParts> make_node_parts(const std::string& name, const std::string& space,
                                           const rclcpp::NodeOptions& options);
#define REHEARSE_PART_OF(part, Interface) \
  std::shared_ptr<rclcpp::node_interfaces::Interface> part##_of(const std::shared_ptr<NodeParts>& parts);
REHEARSE_NODE_INTERFACES(REHEARSE_PART_OF)
#undef REHEARSE_PART_OF

}  // namespace rehearse_ros2

namespace rclcpp {

// Functions that make parts of a node from its interfaces.

template <class Message, class Allocator = std::allocator<void>, class PublisherType = Publisher<Message, Allocator>,
          class NodeType>
std::shared_ptr<PublisherType> create_publisher(NodeType&& node, const std::string& topic, const QoS& qos,
                                                const PublisherOptions& options = PublisherOptions()) {
  const auto topics = node_interfaces::get_node_topics_interface(std::forward<NodeType>(node));
  auto publisher = std::make_shared<PublisherType>(topics->resolve_topic_name(topic), qos);
  topics->add_publisher(publisher, options.callback_group);
  return publisher;
}
template <class Message, class Allocator = std::allocator<void>, class PublisherType = Publisher<Message, Allocator>>
std::shared_ptr<PublisherType> create_publisher(const node_interfaces::NodeParametersInterface::SharedPtr&,
                                                const node_interfaces::NodeTopicsInterface::SharedPtr& topics,
                                                const std::string& topic, const QoS& qos,
                                                const PublisherOptions& options = PublisherOptions()) {
  return create_publisher<Message, Allocator, PublisherType>(topics, topic, qos, options);
}

template <class Message, class Callback, class NodeType>
std::shared_ptr<Subscription<Message>> create_subscription(NodeType&& node, const std::string& topic, const QoS& qos,
                                                           Callback&& callback,
                                                           const SubscriptionOptions& options = SubscriptionOptions()) {
  const auto topics = node_interfaces::get_node_topics_interface(std::forward<NodeType>(node));
  auto subscription = std::make_shared<Subscription<Message>>(topics->resolve_topic_name(topic), qos,
                                                              std::decay_t<Callback>(std::forward<Callback>(callback)));
  topics->add_subscription(subscription, options.callback_group);
  return subscription;
}
template <class Message, class Callback>
std::shared_ptr<Subscription<Message>> create_subscription(
    const node_interfaces::NodeParametersInterface::SharedPtr&,
    const node_interfaces::NodeTopicsInterface::SharedPtr& topics, const std::string& topic, const QoS& qos,
    Callback&& callback, const SubscriptionOptions& options = SubscriptionOptions()) {
  return create_subscription<Message>(topics, topic, qos, std::forward<Callback>(callback), options);
}

template <class Type, class Callback>
std::shared_ptr<Service<Type>> create_service(const node_interfaces::NodeBaseInterface::SharedPtr&,
                                              const node_interfaces::NodeServicesInterface::SharedPtr& services,
                                              const std::string& name, Callback&& callback, const QoS& = ServicesQoS(),
                                              CallbackGroup::SharedPtr group = nullptr) {
  auto service = std::make_shared<Service<Type>>(services->resolve_service_name(name),
                                                 std::decay_t<Callback>(std::forward<Callback>(callback)));
  services->add_service(service, group);
  return service;
}
template <class Type>
std::shared_ptr<Client<Type>> create_client(const node_interfaces::NodeBaseInterface::SharedPtr&,
                                            const node_interfaces::NodeGraphInterface::SharedPtr&,
                                            const node_interfaces::NodeServicesInterface::SharedPtr& services,
                                            const std::string& name, const QoS& = ServicesQoS(),
                                            CallbackGroup::SharedPtr group = nullptr) {
  auto client = std::make_shared<Client<Type>>(services->resolve_service_name(name));
  services->add_client(client, group);
  return client;
}

template <class Callback>
std::shared_ptr<GenericTimer<std::decay_t<Callback>>> create_timer(
    Clock::SharedPtr clock, std::chrono::nanoseconds period, Callback&& callback, CallbackGroup::SharedPtr group,
    node_interfaces::NodeBaseInterface*, node_interfaces::NodeTimersInterface* timers, bool starts = true) {
  auto timer = std::make_shared<GenericTimer<std::decay_t<Callback>>>(
      std::move(clock), period, std::decay_t<Callback>(std::forward<Callback>(callback)), nullptr, starts);
  timers->add_timer(timer, group);
  return timer;
}
template <class NodeType, class Callback>
TimerBase::SharedPtr create_timer(NodeType node, Clock::SharedPtr clock, Duration period, Callback&& callback,
                                  CallbackGroup::SharedPtr group = nullptr, bool starts = true) {
  return create_timer(std::move(clock), period.to_chrono<std::chrono::nanoseconds>(), std::forward<Callback>(callback),
                      group, nullptr, node_interfaces::get_node_timers_interface(node).get(), starts);
}
template <class Count, class Period, class Callback>
std::shared_ptr<GenericTimer<std::decay_t<Callback>>> create_wall_timer(
    std::chrono::duration<Count, Period> period, Callback&& callback, CallbackGroup::SharedPtr group,
    node_interfaces::NodeBaseInterface* base, node_interfaces::NodeTimersInterface* timers, bool starts = true) {
  return create_timer(std::make_shared<Clock>(RCL_STEADY_TIME),
                      std::chrono::duration_cast<std::chrono::nanoseconds>(period), std::forward<Callback>(callback),
                      group, base, timers, starts);
}

/// What Node and LifecycleNode share.
class RehearseNode {
 public:
  using Descriptor = rcl_interfaces::msg::ParameterDescriptor;
  using Result = rcl_interfaces::msg::SetParametersResult;
  using PreSetParametersCallbackHandle = node_interfaces::PreSetParametersCallbackHandle;
  using OnSetParametersCallbackHandle = node_interfaces::OnSetParametersCallbackHandle;
  using PostSetParametersCallbackHandle = node_interfaces::PostSetParametersCallbackHandle;
  using PreSetParametersCallbackType = PreSetParametersCallbackHandle::PreSetParametersCallbackType;
  using OnSetParametersCallbackType = OnSetParametersCallbackHandle::OnSetParametersCallbackType;
  using OnParametersSetCallbackType = OnSetParametersCallbackType;
  using PostSetParametersCallbackType = PostSetParametersCallbackHandle::PostSetParametersCallbackType;

  RehearseNode(const std::string& name, const std::string& space, const NodeOptions& options)
      : parts_(rehearse_ros2::make_node_parts(name, space, options)), options_(options) {}
  RCLCPP_DISABLE_COPY(RehearseNode)

#define REHEARSE_GETTER(part, Interface)                                            \
  std::shared_ptr<node_interfaces::Interface> get_node_##part##_interface() const { \
    return rehearse_ros2::part##_of(parts_);                                        \
  }
  REHEARSE_NODE_INTERFACES(REHEARSE_GETTER)
#undef REHEARSE_GETTER

  const char* get_name() const { return base().get_name(); }
  const char* get_namespace() const { return base().get_namespace(); }
  const char* get_fully_qualified_name() const { return base().get_fully_qualified_name(); }
  std::string get_effective_namespace() const { return get_namespace(); }
  Logger get_logger() const { return get_node_logging_interface()->get_logger(); }
  Clock::SharedPtr get_clock() { return get_node_clock_interface()->get_clock(); }
  Clock::ConstSharedPtr get_clock() const { return get_node_clock_interface()->get_clock(); }
  Time now() const { return get_clock()->now(); }
  const NodeOptions& get_node_options() const { return options_; }
  CallbackGroup::SharedPtr create_callback_group(CallbackGroupType type, bool with_node = true) {
    return base().create_callback_group(type, with_node);
  }
  void for_each_callback_group(const std::function<void(CallbackGroup::SharedPtr)>& function) {
    base().for_each_callback_group(function);
  }

  template <class Message, class Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(
      const std::string& topic, const QoS& qos, Callback&& callback,
      const SubscriptionOptions& options = SubscriptionOptions()) {
    return rclcpp::create_subscription<Message>(get_node_topics_interface(), topic, qos,
                                                std::forward<Callback>(callback), options);
  }
  template <class Count, class Period, class Callback>
  auto create_wall_timer(std::chrono::duration<Count, Period> period, Callback callback,
                         CallbackGroup::SharedPtr group = nullptr, bool starts = true) {
    return rclcpp::create_wall_timer(period, std::move(callback), group, nullptr, get_node_timers_interface().get(),
                                     starts);
  }
  template <class Count, class Period, class Callback>
  auto create_timer(std::chrono::duration<Count, Period> period, Callback callback,
                    CallbackGroup::SharedPtr group = nullptr) {
    return rclcpp::create_timer(get_clock(), std::chrono::duration_cast<std::chrono::nanoseconds>(period),
                                std::move(callback), group, nullptr, get_node_timers_interface().get());
  }
  template <class Type>
  std::shared_ptr<Client<Type>> create_client(const std::string& name, const QoS& qos = ServicesQoS(),
                                              CallbackGroup::SharedPtr group = nullptr) {
    return rclcpp::create_client<Type>(nullptr, nullptr, get_node_services_interface(), name, qos, group);
  }
  template <class Type>
  std::shared_ptr<Client<Type>> create_client(const std::string& name, const rmw_qos_profile_t&,
                                              CallbackGroup::SharedPtr group = nullptr) {
    return create_client<Type>(name, ServicesQoS(), group);
  }
  template <class Type, class Callback>
  std::shared_ptr<Service<Type>> create_service(const std::string& name, Callback&& callback,
                                                const QoS& qos = ServicesQoS(),
                                                CallbackGroup::SharedPtr group = nullptr) {
    return rclcpp::create_service<Type>(nullptr, get_node_services_interface(), name, std::forward<Callback>(callback),
                                        qos, group);
  }
  template <class Type, class Callback>
  std::shared_ptr<Service<Type>> create_service(const std::string& name, Callback&& callback, const rmw_qos_profile_t&,
                                                CallbackGroup::SharedPtr group = nullptr) {
    return create_service<Type>(name, std::forward<Callback>(callback), ServicesQoS(), group);
  }

  // Parameters.
  const ParameterValue& declare_parameter(const std::string& name, const ParameterValue& value,
                                          const Descriptor& descriptor = Descriptor(), bool ignore_override = false) {
    return parameters().declare_parameter(name, value, descriptor, ignore_override);
  }
  const ParameterValue& declare_parameter(const std::string& name, ParameterType type,
                                          const Descriptor& descriptor = Descriptor(), bool ignore_override = false) {
    return parameters().declare_parameter(name, type, descriptor, ignore_override);
  }
  template <class Value>
  auto declare_parameter(const std::string& name, const Value& value, const Descriptor& descriptor = Descriptor(),
                         bool ignore_override = false) {
    using Kept = std::conditional_t<std::is_convertible_v<Value, std::string>, std::string, Value>;
    try {
      return Kept(
          declare_parameter(name, ParameterValue(Kept(value)), descriptor, ignore_override).template get<Kept>());
    } catch (const ParameterTypeException& wrong) {
      throw exceptions::InvalidParameterTypeException(name, wrong.what());
    }
  }
  template <class Value>
  Value declare_parameter(const std::string& name, const Descriptor& descriptor = Descriptor(),
                          bool ignore_override = false) {
    const ParameterValue& declared =
        declare_parameter(name, detail::parameter_type_of<Value>(), descriptor, ignore_override);
    if (declared.get_type() == PARAMETER_NOT_SET)
      throw exceptions::ParameterUninitializedException("parameter '" + name + "' is not initialized");
    return declared.get<Value>();
  }
  template <class Value>
  std::vector<Value> declare_parameters(const std::string& space, const std::map<std::string, Value>& values,
                                        bool ignore_overrides = false) {
    std::vector<Value> declared;
    for (const auto& [name, value] : values)
      declared.push_back(
          declare_parameter(space.empty() ? name : space + "." + name, value, Descriptor(), ignore_overrides));
    return declared;
  }
  void undeclare_parameter(const std::string& name) { parameters().undeclare_parameter(name); }
  bool has_parameter(const std::string& name) const { return parameters().has_parameter(name); }
  Result set_parameter(const Parameter& parameter) { return parameters().set_parameters({parameter}).front(); }
  std::vector<Result> set_parameters(const std::vector<Parameter>& all) { return parameters().set_parameters(all); }
  Result set_parameters_atomically(const std::vector<Parameter>& all) {
    return parameters().set_parameters_atomically(all);
  }
  Parameter get_parameter(const std::string& name) const { return parameters().get_parameter(name); }
  bool get_parameter(const std::string& name, Parameter& parameter) const {
    return parameters().get_parameter(name, parameter);
  }
  template <class Value>
  bool get_parameter(const std::string& name, Value& value) const {
    Parameter parameter;
    if (!parameters().get_parameter(name, parameter)) return false;
    value = parameter.get_value<Value>();
    return true;
  }
  template <class Value>
  bool get_parameter_or(const std::string& name, Value& value, const Value& other) const {
    if (get_parameter(name, value)) return true;
    value = other;
    return false;
  }
  template <class Value>
  Value get_parameter_or(const std::string& name, const Value& other) const {
    Value value;
    get_parameter_or(name, value, other);
    return value;
  }
  std::vector<Parameter> get_parameters(const std::vector<std::string>& names) const {
    return parameters().get_parameters(names);
  }
  template <class Value>
  bool get_parameters(const std::string& prefix, std::map<std::string, Value>& values) const {
    std::map<std::string, Parameter> found;
    if (!parameters().get_parameters_by_prefix(prefix, found)) return false;
    for (const auto& [name, parameter] : found) values[name] = parameter.template get_value<Value>();
    return true;
  }
  Descriptor describe_parameter(const std::string& name) const {
    return parameters().describe_parameters({name}).at(0);
  }
  std::vector<Descriptor> describe_parameters(const std::vector<std::string>& names) const {
    return parameters().describe_parameters(names);
  }
  std::vector<std::uint8_t> get_parameter_types(const std::vector<std::string>& names) const {
    return parameters().get_parameter_types(names);
  }
  rcl_interfaces::msg::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                            std::uint64_t depth) const {
    return parameters().list_parameters(prefixes, depth);
  }
  [[nodiscard]] PreSetParametersCallbackHandle::SharedPtr add_pre_set_parameters_callback(
      PreSetParametersCallbackType callback) {
    return parameters().add_pre_set_parameters_callback(std::move(callback));
  }
  [[nodiscard]] OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      OnSetParametersCallbackType callback) {
    return parameters().add_on_set_parameters_callback(std::move(callback));
  }
  [[nodiscard]] PostSetParametersCallbackHandle::SharedPtr add_post_set_parameters_callback(
      PostSetParametersCallbackType callback) {
    return parameters().add_post_set_parameters_callback(std::move(callback));
  }
  void remove_pre_set_parameters_callback(const PreSetParametersCallbackHandle* handle) {
    parameters().remove_pre_set_parameters_callback(handle);
  }
  void remove_on_set_parameters_callback(const OnSetParametersCallbackHandle* handle) {
    parameters().remove_on_set_parameters_callback(handle);
  }
  void remove_post_set_parameters_callback(const PostSetParametersCallbackHandle* handle) {
    parameters().remove_post_set_parameters_callback(handle);
  }

  // Other nodes of the process.
  std::vector<std::string> get_node_names() const { return graph().get_node_names(); }
  std::map<std::string, std::vector<std::string>> get_topic_names_and_types() const {
    return graph().get_topic_names_and_types();
  }
  std::map<std::string, std::vector<std::string>> get_service_names_and_types() const {
    return graph().get_service_names_and_types();
  }
  std::size_t count_publishers(const std::string& topic) const { return graph().count_publishers(topic); }
  std::size_t count_subscribers(const std::string& topic) const { return graph().count_subscribers(topic); }

 protected:
  node_interfaces::NodeBaseInterface& base() const { return *rehearse_ros2::base_of(parts_); }
  node_interfaces::NodeGraphInterface& graph() const { return *rehearse_ros2::graph_of(parts_); }
  node_interfaces::NodeParametersInterface& parameters() const { return *rehearse_ros2::parameters_of(parts_); }

 private:
  std::shared_ptr<rehearse_ros2::NodeParts> parts_;
  NodeOptions options_;
};

class Node : public RehearseNode, public std::enable_shared_from_this<Node> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Node)
  explicit Node(const std::string& name, const NodeOptions& options = NodeOptions())
      : RehearseNode(name, "", options) {}
  Node(const std::string& name, const std::string& space, const NodeOptions& options = NodeOptions())
      : RehearseNode(name, space, options) {}
  virtual ~Node() = default;
  template <class Message, class Allocator = std::allocator<void>>
  std::shared_ptr<Publisher<Message, Allocator>> create_publisher(
      const std::string& topic, const QoS& qos, const PublisherOptions& options = PublisherOptions()) {
    return rclcpp::create_publisher<Message, Allocator>(get_node_topics_interface(), topic, qos, options);
  }
};

}  // namespace rclcpp
