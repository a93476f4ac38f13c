#include "rclcpp/node.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <rcl_interfaces/srv/describe_parameters.hpp>
#include <rcl_interfaces/srv/get_parameter_types.hpp>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rcl_interfaces/srv/list_parameters.hpp>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <rcl_interfaces/srv/set_parameters_atomically.hpp>

#include "node_parameters.h"

namespace rehearse_ros2 {
namespace {

namespace interfaces = rclcpp::node_interfaces;
namespace exceptions = rclcpp::exceptions;

void check_letters(const std::string& text, std::string_view others, const std::string& what) {
  for (const char letter : text)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && others.find(letter) == std::string_view::npos)
      throw exceptions::NameValidationError(what + " '" + text + "' has the letter '" + std::string(1, letter) + "'");
}

template <class Exception, class Check>
void checked(Check check) {
  try {
    check();
  } catch (const exceptions::NameValidationError& problem) {
    throw Exception(problem.what());
  }
}

std::vector<std::weak_ptr<NodeParts>>& all_nodes() {
  static std::vector<std::weak_ptr<NodeParts>> nodes;
  return nodes;
}

}  // namespace

class NodeParts : public interfaces::NodeBaseInterface,
                  public interfaces::NodeLoggingInterface,
                  public interfaces::NodeClockInterface,
                  public interfaces::NodeGraphInterface,
                  public interfaces::NodeTopicsInterface,
                  public interfaces::NodeServicesInterface,
                  public interfaces::NodeTimersInterface,
                  public interfaces::NodeWaitablesInterface,
                  public interfaces::NodeTimeSourceInterface,
                  public interfaces::NodeTypeDescriptionsInterface,
                  public std::enable_shared_from_this<NodeParts> {
 public:
  NodeParts(const std::string& given_name, const std::string& given_space, const rclcpp::NodeOptions& options)
      : context_(options.context() ? options.context() : rclcpp::get_global_default_context()),
        uses_intra_process_(options.use_intra_process_comms()),
        clock_(std::make_shared<rclcpp::Clock>(options.clock_type())) {
    if (!context_->is_valid())
      throw exceptions::RCLError("a node needs a valid context: rclcpp::init() was not called, or it was shut down");
    std::vector<std::vector<std::string>> lists;
    if (options.use_global_arguments()) lists.push_back(context_->rehearse_arguments());
    lists.push_back(options.arguments());
    NodeArguments arguments = read_arguments(given_name, given_space, lists);
    name_ = arguments.name;
    space_ = full_namespace(arguments.space);
    remaps_ = std::move(arguments.remaps);
    checked<exceptions::InvalidNodeNameError>([this] {
      if (name_.empty()) throw exceptions::NameValidationError("Invalid node name: node name must not be empty");
      check_letters(name_, "_", "Invalid node name:");
      if (std::isdigit(static_cast<unsigned char>(name_[0])) != 0)
        throw exceptions::NameValidationError("Invalid node name: '" + name_ + "' begins with a digit");
    });
    checked<exceptions::InvalidNamespaceError>([this] { check_letters(space_, "_/", "Invalid namespace:"); });
    full_name_ = full_name(space_, name_);
    logger_name_ = full_name_.substr(1);
    std::replace(logger_name_.begin(), logger_name_.end(), '/', '.');
    default_group_ = create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, true);
    parameters_ = std::make_shared<NodeParameters>(std::move(arguments.overrides), options);
    clock_->rehearse_set_simulated(parameters_->get_parameter("use_sim_time").as_bool());
    if (options.start_parameter_event_publisher()) {
      parameter_events_ = std::make_shared<rclcpp::Publisher<rcl_interfaces::msg::ParameterEvent>>(
          "/parameter_events", options.parameter_event_qos());
      add_publisher(parameter_events_, nullptr);
    }
    parameters_->on_change = [this](const auto& declared, const auto& changed) { tell(declared, changed); };
    if (options.start_parameter_services()) add_parameter_services();
  }

  // Base.
  const char* get_name() const override { return name_.c_str(); }
  const char* get_namespace() const override { return space_.c_str(); }
  const char* get_fully_qualified_name() const override { return full_name_.c_str(); }
  rclcpp::Context::SharedPtr get_context() override { return context_; }
  rclcpp::CallbackGroup::SharedPtr create_callback_group(rclcpp::CallbackGroupType type, bool with_node) override {
    auto group = std::make_shared<rclcpp::CallbackGroup>(type, with_node);
    const BusLock lock(Bus::instance().mutex);
    groups_.push_back(group);
    return group;
  }
  rclcpp::CallbackGroup::SharedPtr get_default_callback_group() override { return default_group_; }
  bool callback_group_in_node(rclcpp::CallbackGroup::SharedPtr group) override {
    bool is_found = false;
    for_each_callback_group([&](const rclcpp::CallbackGroup::SharedPtr& own) { is_found |= own == group; });
    return is_found;
  }
  void for_each_callback_group(const std::function<void(rclcpp::CallbackGroup::SharedPtr)>& function) override {
    std::vector<rclcpp::CallbackGroup::WeakPtr> groups;
    {
      const BusLock lock(Bus::instance().mutex);
      groups = groups_;
    }
    for (const auto& known : groups)
      if (const auto group = known.lock()) function(group);
  }
  std::atomic_bool& get_associated_with_executor_atomic() override { return has_executor_; }
  bool get_use_intra_process_default() const override { return uses_intra_process_; }
  bool get_enable_topic_statistics_default() const override { return false; }
  std::string resolve_topic_or_service_name(const std::string& name, bool is_service, bool only_expand) const override {
    const auto check = [&] {
      if (name.empty()) throw exceptions::NameValidationError("Invalid topic name: it is empty");
      check_letters(name, "_/~{}", "Invalid topic name:");
      if (name.size() > 1 && name.back() == '/')
        throw exceptions::NameValidationError("Invalid topic name: '" + name + "' ends with '/'");
    };
    if (is_service)
      checked<exceptions::InvalidServiceNameError>(check);
    else
      checked<exceptions::InvalidTopicNameError>(check);
    const std::string full = expanded(name);
    if (only_expand) return full;
    for (const auto& [from, to] : remaps_)
      if (expanded(from) == full) return expanded(to);
    return full;
  }

  // Logging and clock.
  rclcpp::Logger get_logger() const override { return rclcpp::Logger(logger_name_); }
  const char* get_logger_name() const override { return logger_name_.c_str(); }
  rclcpp::Clock::SharedPtr get_clock() override { return clock_; }
  rclcpp::Clock::ConstSharedPtr get_clock() const override { return clock_; }

  // Graph.
  NamesAndTypes get_topic_names_and_types(bool) const override {
    NamesAndTypes all;
    for (const auto& [name, type] : Topics::instance().names_and_types()) all[name] = {type};
    return all;
  }
  NamesAndTypes get_service_names_and_types() const override {
    const BusLock lock(Bus::instance().mutex);
    NamesAndTypes all;
    for (const auto& [name, known] : rclcpp::rehearse_services()) {
      const auto service = known.lock();
      if (!service) continue;
      std::string type = type_name_of(service->request_type);
      all[name] = {type.substr(0, type.rfind("_Request"))};
    }
    return all;
  }
  std::vector<std::string> get_node_names() const override;
  std::size_t count_publishers(const std::string& topic) const override {
    return Topics::instance().count_publishers(resolve_topic_or_service_name(topic, false, true));
  }
  std::size_t count_subscribers(const std::string& topic) const override {
    return Topics::instance().count_subscriptions(resolve_topic_or_service_name(topic, false, true));
  }

  // Topics, services, timers, waitables.
  void add_publisher(rclcpp::PublisherBase::SharedPtr publisher, rclcpp::CallbackGroup::SharedPtr) override {
    publisher->rehearse_endpoint()->node = full_name_;
    Topics::instance().add_publisher(publisher->rehearse_endpoint());
  }
  void add_subscription(rclcpp::SubscriptionBase::SharedPtr subscription,
                        rclcpp::CallbackGroup::SharedPtr group) override {
    in(group).rehearse_add(EntityKind::subscription, subscription);
    subscription->rehearse_endpoint()->node = full_name_;
    Topics::instance().add_subscription(subscription->rehearse_endpoint());
  }
  interfaces::NodeBaseInterface* get_node_base_interface() const override { return const_cast<NodeParts*>(this); }
  std::string resolve_topic_name(const std::string& name, bool only_expand) const override {
    return resolve_topic_or_service_name(name, false, only_expand);
  }
  void add_client(rclcpp::ClientBase::SharedPtr client, rclcpp::CallbackGroup::SharedPtr group) override {
    in(group).rehearse_add(EntityKind::client, client);
  }
  void add_service(rclcpp::ServiceBase::SharedPtr service, rclcpp::CallbackGroup::SharedPtr group) override {
    {
      const BusLock lock(Bus::instance().mutex);
      rclcpp::rehearse_services()[service->get_service_name()] = service;
    }
    in(group).rehearse_add(EntityKind::service, service);
  }
  std::string resolve_service_name(const std::string& name, bool only_expand) const override {
    return resolve_topic_or_service_name(name, true, only_expand);
  }
  void add_timer(rclcpp::TimerBase::SharedPtr timer, rclcpp::CallbackGroup::SharedPtr group) override {
    in(group).rehearse_add(EntityKind::timer, timer);
  }
  void add_waitable(rclcpp::Waitable::SharedPtr waitable, rclcpp::CallbackGroup::SharedPtr group) override {
    in(group).rehearse_add(EntityKind::waitable, waitable);
  }
  void remove_waitable(rclcpp::Waitable::SharedPtr waitable, rclcpp::CallbackGroup::SharedPtr group) noexcept override {
    in(group).rehearse_remove(EntityKind::waitable, waitable);
  }

  const std::shared_ptr<NodeParameters>& parameters() const { return parameters_; }

 private:
  rclcpp::CallbackGroup& in(const rclcpp::CallbackGroup::SharedPtr& group) { return group ? *group : *default_group_; }

  std::string expanded(std::string name) const {
    for (const auto& [word, value] : {std::pair<std::string, std::string>{"{node}", name_},
                                      {"{ns}", space_ == "/" ? "" : space_},
                                      {"{namespace}", space_ == "/" ? "" : space_}})
      if (const std::size_t at = name.find(word); at != std::string::npos) name.replace(at, word.size(), value);
    if (name[0] == '/') return name;
    if (name[0] == '~') return full_name_ + name.substr(1);
    return (space_ == "/" ? "" : space_) + "/" + name;
  }

  void tell(const std::vector<rclcpp::Parameter>& declared, const std::vector<rclcpp::Parameter>& changed) {
    for (const rclcpp::Parameter& parameter : changed)
      if (parameter.get_name() == "use_sim_time") clock_->rehearse_set_simulated(parameter.as_bool());
    if (!parameter_events_) return;
    rcl_interfaces::msg::ParameterEvent event;
    event.stamp = clock_->now();
    event.node = full_name_;
    for (const rclcpp::Parameter& parameter : declared) event.new_parameters.push_back(parameter.to_parameter_msg());
    for (const rclcpp::Parameter& parameter : changed) event.changed_parameters.push_back(parameter.to_parameter_msg());
    parameter_events_->publish(event);
  }

  template <class Type, class Answer>
  void add_service_of(const std::string& name, Answer answer) {
    using Request = std::shared_ptr<typename Type::Request>;
    using Response = std::shared_ptr<typename Type::Response>;
    auto service = std::make_shared<rclcpp::Service<Type>>(
        full_name_ + "/" + name, [answer](const Request request, Response response) { answer(*request, *response); });
    add_service(service, nullptr);
    services_.push_back(std::move(service));
  }

  void add_parameter_services() {
    using namespace rcl_interfaces::srv;
    NodeParameters* const all = parameters_.get();
    add_service_of<DescribeParameters>("describe_parameters", [all](const auto& request, auto& response) {
      for (const std::string& name : request.names)
        if (all->has_parameter(name)) response.descriptors.push_back(all->describe_parameters({name})[0]);
    });
    add_service_of<GetParameters>("get_parameters", [all](const auto& request, auto& response) {
      for (const std::string& name : request.names) {
        rclcpp::Parameter parameter(name);
        all->get_parameter(name, parameter);
        response.values.push_back(parameter.get_value_message());
      }
    });
    add_service_of<GetParameterTypes>("get_parameter_types", [all](const auto& request, auto& response) {
      for (const std::string& name : request.names) {
        rclcpp::Parameter parameter(name);
        all->get_parameter(name, parameter);
        response.types.push_back(parameter.get_type());
      }
    });
    add_service_of<ListParameters>("list_parameters", [all](const auto& request, auto& response) {
      response.result = all->list_parameters(request.prefixes, request.depth);
    });
    const auto set = [all](const std::vector<rcl_interfaces::msg::Parameter>& messages) {
      std::vector<rclcpp::Parameter> parameters;
      for (const auto& message : messages) parameters.emplace_back(message);
      try {
        return all->set_parameters_atomically(parameters);
      } catch (const std::exception& problem) {
        rcl_interfaces::msg::SetParametersResult result;
        result.reason = problem.what();
        return result;
      }
    };
    add_service_of<SetParameters>("set_parameters", [set](const auto& request, auto& response) {
      for (const auto& parameter : request.parameters) response.results.push_back(set({parameter}));
    });
    add_service_of<SetParametersAtomically>("set_parameters_atomically", [set](const auto& request, auto& response) {
      response.result = set(request.parameters);
    });
  }

  std::string name_, space_, full_name_, logger_name_;
  std::vector<std::pair<std::string, std::string>> remaps_;
  rclcpp::Context::SharedPtr context_;
  bool uses_intra_process_;
  rclcpp::Clock::SharedPtr clock_;
  std::atomic_bool has_executor_{false};
  std::vector<rclcpp::CallbackGroup::WeakPtr> groups_;
  rclcpp::CallbackGroup::SharedPtr default_group_;
  std::shared_ptr<NodeParameters> parameters_;
  rclcpp::Publisher<rcl_interfaces::msg::ParameterEvent>::SharedPtr parameter_events_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
};

std::vector<std::string> NodeParts::get_node_names() const {
  const BusLock lock(Bus::instance().mutex);
  std::vector<std::string> names;
  for (const auto& known : all_nodes())
    if (const auto node = known.lock()) names.emplace_back(node->get_fully_qualified_name());
  return names;
}

std::shared_ptr<NodeParts> make_node_parts(const std::string& name, const std::string& space,
                                           const rclcpp::NodeOptions& options) {
  auto parts = std::make_shared<NodeParts>(name, space, options);
  const BusLock lock(Bus::instance().mutex);
  auto& nodes = all_nodes();
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.expired(); }), nodes.end());
  nodes.push_back(parts);
  return parts;
}

/// The parameters keep the node alive, as its other parts do.
std::shared_ptr<interfaces::NodeParametersInterface> parameters_of(const std::shared_ptr<NodeParts>& parts) {
  return {parts, parts->parameters().get()};
}
#define REHEARSE_PART_OF(part, Interface) \
  std::shared_ptr<interfaces::Interface> part##_of(const std::shared_ptr<NodeParts>& parts) { return parts; }
REHEARSE_PART_OF(base, NodeBaseInterface)
REHEARSE_PART_OF(clock, NodeClockInterface)
REHEARSE_PART_OF(graph, NodeGraphInterface)
REHEARSE_PART_OF(logging, NodeLoggingInterface)
REHEARSE_PART_OF(services, NodeServicesInterface)
REHEARSE_PART_OF(time_source, NodeTimeSourceInterface)
REHEARSE_PART_OF(timers, NodeTimersInterface)
REHEARSE_PART_OF(topics, NodeTopicsInterface)
REHEARSE_PART_OF(type_descriptions, NodeTypeDescriptionsInterface)
REHEARSE_PART_OF(waitables, NodeWaitablesInterface)
#undef REHEARSE_PART_OF

}  // namespace rehearse_ros2
