#include "guest.h"

#include <rcutils/logging.h>
#include <rehearse_variable.h>

#include <cctype>
#include <lifecycle_msgs/srv/change_state.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <rcl_interfaces/srv/set_parameters_atomically.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <string>
#include <vector>

#include "guest_options.h"
#include "robot_topics.h"

namespace rehearse::ros2 {
namespace {

constexpr std::int64_t start_date = 1'767'225'600'000'000'000;  // [ns] since 1970: 2026-01-01, as dates of a run begin
constexpr int most_callbacks = 100'000;                         // in a tick

using ChangeState = lifecycle_msgs::srv::ChangeState;

/// Lines of logs of all guests, until a call of one takes them.
class Lines {
 public:
  static Lines& instance() {
    static Lines lines;
    return lines;
  }
  void add(int severity, std::string line) {
    const std::lock_guard lock(mutex_);
    if (severity >= RCUTILS_LOG_SEVERITY_WARN && severity > worst_severity_) {
      worst_severity_ = severity;
      worst_ = line;
    }
    lines_.push_back(std::move(line));
  }
  /// Prints the lines since the last call. Returns the first of those of the greatest level; empty: there is no warning
  /// or error.
  std::string print(rehearse_io* io) {
    std::vector<std::string> lines;
    std::string worst;
    {
      const std::lock_guard lock(mutex_);
      lines.swap(lines_);
      worst.swap(worst_);
      worst_severity_ = 0;
    }
    for (const std::string& line : lines) rehearse_print(io, (line + "\n").c_str());
    return worst;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
  int worst_severity_ = 0;
  std::string worst_;
};

void take_line(const rcutils_log_location_t*, int severity, const char* name, rcutils_time_point_value_t,
               const char* format, va_list* arguments) {
  va_list copy;
  va_copy(copy, *arguments);
  const int size = std::vsnprintf(nullptr, 0, format, copy);
  va_end(copy);
  std::string text(size < 0 ? 0 : static_cast<std::size_t>(size), ' ');
  std::vsnprintf(text.data(), text.size() + 1, format, *arguments);
  Lines::instance().add(severity,
                        std::string("[") + g_rcutils_log_severity_names[severity] + "] [" + name + "]: " + text);
}

/// The numbers of messages that nodes published since the last tick, by node, then by "topic/field".
class PublishedNumbers {
 public:
  static PublishedNumbers& instance() {
    static PublishedNumbers numbers;
    return numbers;
  }
  /// From now on those of this node are taken.
  void listen_to(const std::string& node) { of_nodes_[node]; }
  void forget() { of_nodes_.clear(); }
  /// Under the lock of the bus.
  void take(const rehearse_ros2::Endpoint& publisher, const void* message) {
    const auto node = of_nodes_.find(publisher.node);
    if (node == of_nodes_.end() || publisher.topic == "/parameter_events") return;
    const std::string prefix = publisher.topic.substr(1) + "/";
    for_each_number(message, publisher.type,
                    [&](const std::string& name, double value) { node->second[prefix + name] = value; });
  }
  void record(const std::string& node) {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    std::map<std::string, double>& numbers = of_nodes_[node];
    for (const auto& [name, value] : numbers) rehearse_variable(name.c_str(), value);
    numbers.clear();
  }

 private:
  std::map<std::string, std::map<std::string, double>> of_nodes_;
};

/// rclcpp is initialised while there is a guest.
class Initialised {
 public:
  Initialised() {
    if (count()++ > 0) return;
    const char* const arguments[] = {"rehearse"};
    rclcpp::init(1, arguments, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None);
    rcutils_logging_set_output_handler(&take_line);
    rehearse_ros2::set_ros_time(start_date);
    rehearse_ros2::Bus::instance().begin_numbers();
    rehearse_ros2::Topics::instance().set_tap([](const rehearse_ros2::Endpoint& publisher, const void* message) {
      PublishedNumbers::instance().take(publisher, message);
    });
  }
  ~Initialised() {
    if (--count() > 0) return;
    rehearse_ros2::Topics::instance().set_tap(nullptr);
    PublishedNumbers::instance().forget();
    if (rclcpp::ok()) rclcpp::shutdown();
  }
  Initialised(const Initialised&) = delete;
  Initialised& operator=(const Initialised&) = delete;

 private:
  static int& count() {
    static int guests = 0;
    return guests;
  }
};

class Guest {
 public:
  explicit Guest(NodeMaker maker) : maker_(std::move(maker)) {}

  int initialize(rehearse_io* io) {
    io_ = io;
    options_ = read_guest_options(rehearse_options(io));
    next_event_ = options_.events.begin();
    initialised_.emplace();
    rclcpp::NodeOptions of_robot;
    of_robot.start_parameter_services(false).start_parameter_event_publisher(false).use_global_arguments(false);
    robot_ = std::make_shared<rclcpp::Node>(name_of_robot(rehearse_name(io)), of_robot);
    for (const TopicBinding& binding : options_.topics) {
      if (auto source = make_source(binding, io, *robot_))
        sources_.push_back(std::move(source));
      else
        sinks_.emplace_back(binding, io);
    }
    rclcpp::NodeOptions options;
    std::vector<std::string> arguments{RCL_ROS_ARGS_FLAG};
    for (const auto& [name, value] : options_.parameters) {
      arguments.emplace_back(RCL_SHORT_PARAM_FLAG);
      arguments.push_back(name + ":=" + value);
    }
    for (const std::string& file : options_.parameter_files) {
      arguments.emplace_back(RCL_PARAM_FILE_FLAG);
      arguments.push_back(file);
    }
    arguments.emplace_back("--");
    arguments.insert(arguments.end(), options_.arguments.begin(), options_.arguments.end());
    options.arguments(arguments);
    node_ = maker_(options);
    if (const auto& driver = node_.rehearse_driver()) {
      driver->initialize(io, options_of_driver(arguments));
      executor_ = driver->executor();
      names_ = driver->nodes();
    } else {
      if (!options_.place_of_controllers.IsNull())
        throw mistake(options_.place_of_controllers, "a node has no controllers, and needs no description");
      names_ = {node_.get_node_base_interface()->get_fully_qualified_name()};
      executor_ = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
      executor_->add_node(node_.get_node_base_interface());
    }
    for (const std::string& name : names_) PublishedNumbers::instance().listen_to(name);
    executor_->add_node(robot_);
    if (is_managed() && options_.configures) transition("configure");
    if (is_managed() && options_.activates) transition("activate");
    for (RobotSink& sink : sinks_) sink.connect();
    return REHEARSE_OK;
  }

  int control() {
    while (next_event_ != options_.events.end() && is_due(*next_event_)) run(*next_event_++);
    for (const auto& source : sources_) source->publish();
    spin();
    if (const auto& driver = node_.rehearse_driver()) driver->control();
    for (RobotSink& sink : sinks_) sink.command();
    return REHEARSE_OK;
  }

  /// Returns the line that tells most about a failure; empty: there is none.
  std::string end_call() {
    std::string worst = Lines::instance().print(io_);
    for (const std::string& name : names_) PublishedNumbers::instance().record(name);
    return worst;
  }
  rehearse_io* io() const { return io_; }

 private:
  static std::string name_of_robot(const std::string& controller) {
    std::string name = "robot_of_" + controller;
    for (char& letter : name)
      if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
    return name;
  }
  /// Of its node, or of the first node of its driver.
  const std::string& name() const { return names_.front(); }
  rehearse_ros2::DriverOptions options_of_driver(const std::vector<std::string>& arguments) const {
    rehearse_ros2::DriverOptions options{
        arguments, options_.parameter_files, options_.description, options_.controllers, {}};
    for (const GuestEvent& event : options_.events)
      options.others.insert(options.others.end(), event.activate.begin(), event.activate.end());
    return options;
  }
  bool is_managed() const { return find_service(name() + "/change_state") != nullptr; }
  static std::shared_ptr<rclcpp::ServiceBase> find_service(const std::string& service) {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    const auto found = rclcpp::rehearse_services().find(service);
    return found == rclcpp::rehearse_services().end() ? nullptr : found->second.lock();
  }
  bool is_due(const GuestEvent& event) const { return rehearse_time(io_) >= event.at - 0.5 * rehearse_time_step(io_); }

  /// Until nothing is ready: as a computer without delays spins.
  void spin() {
    for (int i = 0; i < most_callbacks; ++i)
      if (!executor_->rehearse_spin_one()) return;
    throw std::runtime_error("'" + name() + "' is never idle: " + std::to_string(most_callbacks) +
                             " callbacks were called in one tick");
  }

  /// Calls the service, and waits for the answer, which must come in this tick.
  std::shared_ptr<void> call(const std::string& target,
                             const std::function<void(void*, const rehearse_ros2::MessageMembers&)>& fill) {
    const auto service = find_service(target);
    if (!service) throw std::runtime_error("nobody has the service '" + target + "'");
    auto request = rehearse_ros2::make_message(service->request_type);
    fill(request.get(), service->request_type);
    const auto answer = std::make_shared<std::shared_ptr<void>>();
    service->rehearse_ask({rehearse_ros2::Bus::instance().next_number(), std::move(request),
                           [answer](std::shared_ptr<void> response) { *answer = std::move(response); }});
    spin();
    if (!*answer) throw std::runtime_error("the service '" + target + "' didn't answer in the tick of the call");
    return *answer;
  }

  void transition(const std::string& label) {
    const auto response = call(name() + "/change_state", [&](void* request, const auto&) {
      static_cast<ChangeState::Request*>(request)->transition.label = label;
    });
    if (!static_cast<const ChangeState::Response*>(response.get())->success)
      throw std::runtime_error("the transition '" + label + "' of '" + name() + "' failed");
  }

  void run(const GuestEvent& event) {
    switch (event.deed) {
      case GuestEvent::Deed::publish: return publish(event);
      case GuestEvent::Deed::transition: return transition(event.target);
      case GuestEvent::Deed::goal: return send_goal(event);
      case GuestEvent::Deed::call:
        call(event.target, [&](void* request, const rehearse_ros2::MessageMembers& type) {
          if (!event.content.IsNull()) set_fields(request, type, event.content);
        });
        return;
      case GuestEvent::Deed::set_parameters: return set_parameters(event);
      case GuestEvent::Deed::switch_controllers:
        if (!node_.rehearse_driver()) throw mistake(event.place, "a node has no controllers to activate");
        return node_.rehearse_driver()->switch_controllers(event.activate, event.deactivate, event.is_strict);
    }
  }

  void publish(const GuestEvent& event) {
    const rehearse_ros2::MessageMembers* type = rehearse_ros2::Topics::instance().type_of(event.target);
    if (type == nullptr) throw mistake(event.place, "nobody listens to the topic '" + event.target + "'");
    auto& publisher = publishers_[event.target];
    if (!publisher) {
      publisher = std::make_shared<rehearse_ros2::Endpoint>(event.target, *type, rclcpp::QoS(1).transient_local());
      rehearse_ros2::Topics::instance().add_publisher(publisher);
    }
    const auto message = rehearse_ros2::make_message(*type);
    if (!event.content.IsNull()) set_fields(message.get(), *type, event.content);
    rehearse_ros2::Topics::instance().publish(*publisher, message);
  }

  /// Sends the goal, which must be accepted in this tick. How it ends is a line of the log.
  void send_goal(const GuestEvent& event) {
    std::shared_ptr<rclcpp_action::ServerBase> server;
    {
      const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
      const auto found = rclcpp_action::rehearse_servers().find(event.target);
      if (found != rclcpp_action::rehearse_servers().end()) server = found->second.lock();
    }
    if (!server) throw std::runtime_error("nobody has the action '" + event.target + "'");
    const auto goal = rehearse_ros2::make_message(server->rehearse_goal_type());
    if (!event.content.IsNull()) set_fields(goal.get(), server->rehearse_goal_type(), event.content);
    rclcpp_action::GoalListener listener;
    listener.on_feedback = [](std::shared_ptr<const void>) {};
    listener.on_status = [](std::int8_t) {};
    listener.on_end = [action = event.target](std::int8_t status, std::shared_ptr<void>) {
      const bool has_succeeded = status == rclcpp_action::GoalStatus::STATUS_SUCCEEDED;
      const bool is_canceled = status == rclcpp_action::GoalStatus::STATUS_CANCELED;
      Lines::instance().add(RCUTILS_LOG_SEVERITY_INFO, "[INFO] [" + action + "]: the goal " +
                                                           (has_succeeded ? "succeeded"
                                                            : is_canceled ? "was canceled"
                                                                          : "was aborted"));
    };
    const auto answer = std::make_shared<std::optional<bool>>();
    server->rehearse_send_goal(rclcpp_action::rehearse_next_id(), goal, listener,
                               [answer](bool is_accepted) { *answer = is_accepted; });
    spin();
    if (!*answer) throw std::runtime_error("the action '" + event.target + "' didn't answer in the tick of the goal");
    if (!**answer) throw std::runtime_error("the action '" + event.target + "' rejected the goal");
  }

  void set_parameters(const GuestEvent& event) {
    const auto response = call(name() + "/set_parameters_atomically", [&](void* request, const auto&) {
      auto& parameters = static_cast<rcl_interfaces::srv::SetParametersAtomically::Request*>(request)->parameters;
      for (const auto& [parameter, value] : event.parameters)
        parameters.push_back(rclcpp::Parameter(parameter, rehearse_ros2::value_of_text(value)).to_parameter_msg());
    });
    const auto& result =
        static_cast<const rcl_interfaces::srv::SetParametersAtomically::Response*>(response.get())->result;
    if (!result.successful) throw std::runtime_error("'" + name() + "' refused parameters: " + result.reason);
  }

  // In the order of their making: what is last goes first.
  NodeMaker maker_;
  std::optional<Initialised> initialised_;
  rehearse_io* io_ = nullptr;
  GuestOptions options_;
  std::list<GuestEvent>::const_iterator next_event_;
  std::vector<std::string> names_;  // of its nodes; empty: they aren't made yet
  std::shared_ptr<rclcpp::Node> robot_;
  std::vector<std::unique_ptr<RobotSource>> sources_;
  std::vector<RobotSink> sinks_;
  std::map<std::string, std::shared_ptr<rehearse_ros2::Endpoint>> publishers_;
  rclcpp_components::NodeInstanceWrapper node_;
  std::shared_ptr<rclcpp::Executor> executor_;
};

/// Calls the code; an exception is the sentence of a failure.
template <class Code>
int guarded(void* self, rehearse_io* io, Code code) {
  auto& guest = *static_cast<Guest*>(self);
  int result = REHEARSE_FAILED;
  std::string problem;
  try {
    result = code(guest);
  } catch (const std::exception& thrown) {
    problem = thrown.what();
  }
  const std::string logged = guest.io() != nullptr ? guest.end_call() : "";
  if (!problem.empty() && !logged.empty()) problem += "; its log: " + logged;
  return problem.empty() ? result : rehearse_set_error(io, problem.c_str());
}

NodeMaker& next_maker() {
  static NodeMaker maker;
  return maker;
}

void* create() { return new Guest(next_maker()); }
int initialize(void* self, rehearse_io* io) {
  return guarded(self, io, [io](Guest& guest) { return guest.initialize(io); });
}
int control(void* self) {
  return guarded(self, static_cast<Guest*>(self)->io(), [](Guest& guest) { return guest.control(); });
}
void destroy(void* self) { delete static_cast<Guest*>(self); }

constexpr rehearse_controller_functions functions = {
    REHEARSE_CONTROLLER_ABI, &create, &initialize, nullptr, &control, nullptr, &destroy};

}  // namespace

const rehearse_controller_functions* functions_of(NodeMaker maker) {
  next_maker() = std::move(maker);
  return &functions;
}

}  // namespace rehearse::ros2
