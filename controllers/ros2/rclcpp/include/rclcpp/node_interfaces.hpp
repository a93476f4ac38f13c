// The interfaces of a node, one for each part of it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/logger.hpp"
#include "rclcpp/parameter.hpp"
#include "rclcpp/publisher.hpp"
#include "rclcpp/service.hpp"
#include "rclcpp/subscription.hpp"
#include "rclcpp/timer.hpp"

namespace rclcpp::node_interfaces {

#define REHEARSE_INTERFACE(Name)      \
 public:                              \
  RCLCPP_SMART_PTR_ALIASES_ONLY(Name) \
  Name() = default;                   \
  virtual ~Name() = default;          \
  RCLCPP_DISABLE_COPY(Name)

class NodeBaseInterface {
  REHEARSE_INTERFACE(NodeBaseInterface)
  virtual const char* get_name() const = 0;
  virtual const char* get_namespace() const = 0;
  virtual const char* get_fully_qualified_name() const = 0;
  virtual Context::SharedPtr get_context() = 0;
  virtual CallbackGroup::SharedPtr create_callback_group(CallbackGroupType type, bool with_node = true) = 0;
  virtual CallbackGroup::SharedPtr get_default_callback_group() = 0;
  virtual bool callback_group_in_node(CallbackGroup::SharedPtr group) = 0;
  virtual void for_each_callback_group(const std::function<void(CallbackGroup::SharedPtr)>& function) = 0;
  virtual std::atomic_bool& get_associated_with_executor_atomic() = 0;
  virtual bool get_use_intra_process_default() const = 0;
  virtual bool get_enable_topic_statistics_default() const = 0;
  virtual std::string resolve_topic_or_service_name(const std::string& name, bool is_service,
                                                    bool only_expand = false) const = 0;
};

class NodeLoggingInterface {
  REHEARSE_INTERFACE(NodeLoggingInterface)
  virtual Logger get_logger() const = 0;
  virtual const char* get_logger_name() const = 0;
};

class NodeClockInterface {
  REHEARSE_INTERFACE(NodeClockInterface)
  virtual Clock::SharedPtr get_clock() = 0;
  virtual Clock::ConstSharedPtr get_clock() const = 0;
};

class NodeTimeSourceInterface {
  REHEARSE_INTERFACE(NodeTimeSourceInterface)
};

class NodeTypeDescriptionsInterface {
  REHEARSE_INTERFACE(NodeTypeDescriptionsInterface)
};

class NodeGraphInterface {
  REHEARSE_INTERFACE(NodeGraphInterface)
  using NamesAndTypes = std::map<std::string, std::vector<std::string>>;
  virtual NamesAndTypes get_topic_names_and_types(bool no_demangle = false) const = 0;
  virtual NamesAndTypes get_service_names_and_types() const = 0;
  virtual std::vector<std::string> get_node_names() const = 0;
  virtual std::size_t count_publishers(const std::string& topic) const = 0;
  virtual std::size_t count_subscribers(const std::string& topic) const = 0;
};

class NodeTopicsInterface {
  REHEARSE_INTERFACE(NodeTopicsInterface)
  virtual void add_publisher(PublisherBase::SharedPtr publisher, CallbackGroup::SharedPtr group) = 0;
  virtual void add_subscription(SubscriptionBase::SharedPtr subscription, CallbackGroup::SharedPtr group) = 0;
  virtual NodeBaseInterface* get_node_base_interface() const = 0;
  virtual std::string resolve_topic_name(const std::string& name, bool only_expand = false) const = 0;
};

class NodeServicesInterface {
  REHEARSE_INTERFACE(NodeServicesInterface)
  virtual void add_client(ClientBase::SharedPtr client, CallbackGroup::SharedPtr group) = 0;
  virtual void add_service(ServiceBase::SharedPtr service, CallbackGroup::SharedPtr group) = 0;
  virtual std::string resolve_service_name(const std::string& name, bool only_expand = false) const = 0;
};

class NodeTimersInterface {
  REHEARSE_INTERFACE(NodeTimersInterface)
  virtual void add_timer(TimerBase::SharedPtr timer, CallbackGroup::SharedPtr group) = 0;
};

class NodeWaitablesInterface {
  REHEARSE_INTERFACE(NodeWaitablesInterface)
  virtual void add_waitable(Waitable::SharedPtr waitable, CallbackGroup::SharedPtr group) = 0;
  virtual void remove_waitable(Waitable::SharedPtr waitable, CallbackGroup::SharedPtr group) noexcept = 0;
};

struct PreSetParametersCallbackHandle {
  RCLCPP_SMART_PTR_DEFINITIONS(PreSetParametersCallbackHandle)
  using PreSetParametersCallbackType = std::function<void(std::vector<Parameter>&)>;
  PreSetParametersCallbackType callback;
};
struct OnSetParametersCallbackHandle {
  RCLCPP_SMART_PTR_DEFINITIONS(OnSetParametersCallbackHandle)
  using OnSetParametersCallbackType =
      std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter>&)>;
  using OnParametersSetCallbackType = OnSetParametersCallbackType;
  OnSetParametersCallbackType callback;
};
struct PostSetParametersCallbackHandle {
  RCLCPP_SMART_PTR_DEFINITIONS(PostSetParametersCallbackHandle)
  using PostSetParametersCallbackType = std::function<void(const std::vector<Parameter>&)>;
  PostSetParametersCallbackType callback;
};

class NodeParametersInterface {
  REHEARSE_INTERFACE(NodeParametersInterface)
  using Descriptor = rcl_interfaces::msg::ParameterDescriptor;
  using Result = rcl_interfaces::msg::SetParametersResult;
  using PreSetParametersCallbackType = PreSetParametersCallbackHandle::PreSetParametersCallbackType;
  using OnSetParametersCallbackType = OnSetParametersCallbackHandle::OnSetParametersCallbackType;
  using OnParametersSetCallbackType = OnSetParametersCallbackType;
  using PostSetParametersCallbackType = PostSetParametersCallbackHandle::PostSetParametersCallbackType;
  virtual const ParameterValue& declare_parameter(const std::string& name, const ParameterValue& value,
                                                  const Descriptor& descriptor = Descriptor(),
                                                  bool ignore_override = false) = 0;
  virtual const ParameterValue& declare_parameter(const std::string& name, ParameterType type,
                                                  const Descriptor& descriptor = Descriptor(),
                                                  bool ignore_override = false) = 0;
  virtual void undeclare_parameter(const std::string& name) = 0;
  virtual bool has_parameter(const std::string& name) const = 0;
  virtual std::vector<Result> set_parameters(const std::vector<Parameter>& parameters) = 0;
  virtual Result set_parameters_atomically(const std::vector<Parameter>& parameters) = 0;
  virtual std::vector<Parameter> get_parameters(const std::vector<std::string>& names) const = 0;
  virtual Parameter get_parameter(const std::string& name) const = 0;
  virtual bool get_parameter(const std::string& name, Parameter& parameter) const = 0;
  virtual bool get_parameters_by_prefix(const std::string& prefix,
                                        std::map<std::string, Parameter>& parameters) const = 0;
  virtual std::vector<Descriptor> describe_parameters(const std::vector<std::string>& names) const = 0;
  virtual std::vector<std::uint8_t> get_parameter_types(const std::vector<std::string>& names) const = 0;
  virtual rcl_interfaces::msg::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                                    std::uint64_t depth) const = 0;
  virtual PreSetParametersCallbackHandle::SharedPtr add_pre_set_parameters_callback(
      PreSetParametersCallbackType callback) = 0;
  virtual OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      OnSetParametersCallbackType callback) = 0;
  virtual PostSetParametersCallbackHandle::SharedPtr add_post_set_parameters_callback(
      PostSetParametersCallbackType callback) = 0;
  virtual void remove_pre_set_parameters_callback(const PreSetParametersCallbackHandle* handle) = 0;
  virtual void remove_on_set_parameters_callback(const OnSetParametersCallbackHandle* handle) = 0;
  virtual void remove_post_set_parameters_callback(const PostSetParametersCallbackHandle* handle) = 0;
  virtual const std::map<std::string, ParameterValue>& get_parameter_overrides() const = 0;
};
#undef REHEARSE_INTERFACE

/// X(part, Interface) for each interface of a node.
#define REHEARSE_NODE_INTERFACES(X)                   \
  X(base, NodeBaseInterface)                          \
  X(clock, NodeClockInterface)                        \
  X(graph, NodeGraphInterface)                        \
  X(logging, NodeLoggingInterface)                    \
  X(parameters, NodeParametersInterface)              \
  X(services, NodeServicesInterface)                  \
  X(time_source, NodeTimeSourceInterface)             \
  X(timers, NodeTimersInterface)                      \
  X(topics, NodeTopicsInterface)                      \
  X(type_descriptions, NodeTypeDescriptionsInterface) \
  X(waitables, NodeWaitablesInterface)

/// Some interfaces of a node.
template <class... Interfaces>
class NodeInterfaces {
 public:
  NodeInterfaces() = default;
  template <class NodeType, class = decltype(std::declval<NodeType&>().get_node_base_interface())>
  NodeInterfaces(NodeType& node) {
#define REHEARSE_TAKE(part, Interface) \
  if constexpr ((std::is_same_v<Interface, Interfaces> || ...)) part##_ = node.get_node_##part##_interface();
    REHEARSE_NODE_INTERFACES(REHEARSE_TAKE)
#undef REHEARSE_TAKE
  }
  template <class NodeType, class = decltype(std::declval<NodeType&>().get_node_base_interface())>
  NodeInterfaces(std::shared_ptr<NodeType> node) : NodeInterfaces(*node) {}
  explicit NodeInterfaces(std::shared_ptr<Interfaces>... interfaces) { (set(interfaces), ...); }

  template <class Interface>
  std::shared_ptr<Interface> get() const {
    static_assert((std::is_same_v<Interface, Interfaces> || ...), "it isn't one of these interfaces");
#define REHEARSE_IF_SAME(part, Other) \
  if constexpr (std::is_same_v<Interface, Other>) return part##_;
    REHEARSE_NODE_INTERFACES(REHEARSE_IF_SAME)
#undef REHEARSE_IF_SAME
  }
#define REHEARSE_PART(part, Interface)                                               \
 public:                                                                             \
  std::shared_ptr<Interface> get_node_##part##_interface() const { return part##_; } \
  std::shared_ptr<Interface> get_##part##_interface() const { return part##_; }      \
                                                                                     \
 private:                                                                            \
  void set(std::shared_ptr<Interface> interface) { part##_ = std::move(interface); } \
  std::shared_ptr<Interface> part##_;
  REHEARSE_NODE_INTERFACES(REHEARSE_PART)
#undef REHEARSE_PART
};

#define ALL_RCLCPP_NODE_INTERFACES                                                                          \
  rclcpp::node_interfaces::NodeBaseInterface, rclcpp::node_interfaces::NodeClockInterface,                  \
      rclcpp::node_interfaces::NodeGraphInterface, rclcpp::node_interfaces::NodeLoggingInterface,           \
      rclcpp::node_interfaces::NodeParametersInterface, rclcpp::node_interfaces::NodeServicesInterface,     \
      rclcpp::node_interfaces::NodeTimeSourceInterface, rclcpp::node_interfaces::NodeTimersInterface,       \
      rclcpp::node_interfaces::NodeTopicsInterface, rclcpp::node_interfaces::NodeTypeDescriptionsInterface, \
      rclcpp::node_interfaces::NodeWaitablesInterface

/// The interface of a node, of a pointer to one, or the interface itself.
#define REHEARSE_GET(part, Interface)                                          \
  template <class NodeType>                                                    \
  std::shared_ptr<Interface> get_node_##part##_interface(NodeType&& node) {    \
    if constexpr (std::is_convertible_v<NodeType, std::shared_ptr<Interface>>) \
      return node;                                                             \
    else if constexpr (requires_member<NodeType>(nullptr))                     \
      return node.get_node_##part##_interface();                               \
    else                                                                       \
      return node->get_node_##part##_interface();                              \
  }
template <class NodeType, class = decltype(std::declval<NodeType>().get_node_base_interface())>
constexpr bool has_base(int) {
  return true;
}
template <class NodeType>
constexpr bool has_base(...) {
  return false;
}
template <class NodeType, class = decltype(std::declval<NodeType>().get_node_topics_interface())>
constexpr bool has_topics(int) {
  return true;
}
template <class NodeType>
constexpr bool has_topics(...) {
  return false;
}
template <class NodeType>
constexpr bool requires_member(std::nullptr_t) {
  return has_base<NodeType>(0) || has_topics<NodeType>(0);
}
REHEARSE_NODE_INTERFACES(REHEARSE_GET)
#undef REHEARSE_GET

}  // namespace rclcpp::node_interfaces
