// The workspace's controller_manager, whose cycle is called in each tick.
#include <dlfcn.h>
#include <rehearse_variable.h>
#include <yaml-cpp/yaml.h>
#include <controller_manager/controller_manager.hpp>
#include <controller_manager_msgs/srv/switch_controller.hpp>
#include <rclcpp_components/register_node_macro.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <thread>

#include "description.h"
#include "robot.h"

namespace rehearse_ros2_control {

using controller_interface::return_type;
using SwitchRequest = controller_manager_msgs::srv::SwitchController::Request;

namespace {

constexpr std::uint8_t active = lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE;

std::uint8_t state_of(const controller_interface::ControllerInterfaceBase& controller) {
#if RCLCPP_VERSION_MAJOR >= 28
  return controller.get_lifecycle_state().id();
#else
  return controller.get_state().id();
#endif
}

/// The type that the controller's own section of a file states, as the spawner reads it. Empty: none. `full`: the
/// controller's name with its namespace.
std::string type_in(const std::vector<std::string>& files, const std::string& controller, const std::string& full) {
  for (const std::string& file : files) {
    const YAML::Node root = YAML::LoadFile(file);
    if (!root.IsMap()) continue;
    for (const std::string& key : {controller, full, "/**/" + controller, "/**" + full})
      if (const YAML::Node section = root[key]; section && section.IsMap())
        if (const YAML::Node parameters = section["ros__parameters"]; parameters && parameters.IsMap())
          if (const YAML::Node type = parameters["type"]; type && type.IsScalar()) return type.Scalar();
  }
  return "";
}

/// Opens the library of the controller: a recording states the files that are opened, and so says whether the
/// controller is another one.
void open_library_of(const controller_interface::ControllerInterfaceBase& controller) {
  Dl_info place{};
  const void* const table = *reinterpret_cast<const void* const*>(&controller);
  if (dladdr(table, &place) != 0) std::ifstream(place.dli_fname).get();
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace

/// Robot::being_made() during its lifetime.
class Making {
 public:
  explicit Making(Robot& robot) { Robot::being_made() = &robot; }
  ~Making() { Robot::being_made() = nullptr; }
  Making(const Making&) = delete;
  Making& operator=(const Making&) = delete;
};

/// A request that waits for the cycle, so it is made in a thread of its own.
class Switch {
 public:
  Switch(controller_manager::ControllerManager& manager, std::vector<std::string> activate,
         std::vector<std::string> deactivate, bool is_strict)
      : activate_(std::move(activate)), deactivate_(std::move(deactivate)), thread_([this, &manager, is_strict] {
          const auto result = manager.switch_controller(activate_, deactivate_,
                                                        is_strict ? SwitchRequest::STRICT : SwitchRequest::BEST_EFFORT,
                                                        true, rclcpp::Duration(longest, 0));
          has_failed_ = result != return_type::OK;
          is_done_ = true;
        }) {}
  ~Switch() { thread_.join(); }
  Switch(const Switch&) = delete;
  Switch& operator=(const Switch&) = delete;
  /// Throws std::runtime_error if it failed.
  bool is_done() const {
    if (is_done_ && has_failed_)
      throw std::runtime_error(
          "controllers can't be switched: " + (activate_.empty() ? "" : "activate " + listed(activate_)) +
          (activate_.empty() || deactivate_.empty() ? "" : ", ") +
          (deactivate_.empty() ? "" : "deactivate " + listed(deactivate_)));
    return is_done_;
  }

 private:
  static constexpr int longest = 5;  // [s]
  std::vector<std::string> activate_, deactivate_;
  std::atomic<bool> is_done_{false}, has_failed_{false};
  std::thread thread_;  // last: it uses the others
};

class ControllerManager final : public rehearse_ros2::RobotDriver {
 public:
  void initialize(rehearse_io* io, const rehearse_ros2::DriverOptions& options) override {
    io_ = io;
    robot_.emplace(io);
    executor_ = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
    rclcpp::NodeOptions of_node = controller_manager::get_cm_node_options();
    of_node.arguments(options.arguments);
    {
      const Making making(*robot_);
      manager_ = std::make_shared<controller_manager::ControllerManager>(
          executor_, read_description(options.description), true, "controller_manager", "", of_node);
    }
    if (!manager_->is_resource_manager_initialized())
      throw std::runtime_error("the hardware of '" + options.description + "' can't be set up");
    executor_->add_node(manager_);
    find_ticks_of_cycle();
    for (const auto* names : {&options.controllers, &options.others})
      for (const std::string& name : *names)
        if (!is_loaded(name)) load(name, options.parameter_files);
    if (!options.controllers.empty()) switch_controllers(options.controllers, {}, true);
  }

  std::shared_ptr<rclcpp::Executor> executor() override { return executor_; }

  std::vector<std::string> nodes() const override {
    std::vector<std::string> names{manager_->get_fully_qualified_name()};
    for (const Controller& controller : controllers_)
      names.push_back(controller.interface->get_node()->get_fully_qualified_name());
    return names;
  }

  void switch_controllers(const std::vector<std::string>& activate, const std::vector<std::string>& deactivate,
                          bool is_strict) override {
    if (switch_ && !switch_->is_done()) throw std::runtime_error("an earlier switch of controllers isn't done");
    switch_.emplace(*manager_, activate, deactivate, is_strict);
    std::this_thread::yield();  // the request is there before the next cycle
  }

  void control() override {
    if (switch_ && switch_->is_done()) switch_.reset();
    const long long tick = std::llround(rehearse_time(io_) / rehearse_time_step(io_));
    if (tick % ticks_of_cycle_ == 0) cycle();
    robot_->record();
    for (const Controller& controller : controllers_)
      rehearse_variable((controller.name + "/state").c_str(), state_of(*controller.interface));
  }

 private:
  struct Controller {
    std::string name;
    controller_interface::ControllerInterfaceBaseSharedPtr interface;
    std::vector<std::string> claimed;  // commands
    bool was_active = false;           // before the present cycle
  };

  bool is_loaded(const std::string& name) const {
    return std::any_of(controllers_.begin(), controllers_.end(),
                       [&](const Controller& controller) { return controller.name == name; });
  }

  std::string full_name_of(const std::string& controller) const {
    const std::string space = manager_->get_namespace();
    return space + (space == "/" ? "" : "/") + controller;
  }

  void find_ticks_of_cycle() {
    const double ticks = 1.0 / (manager_->get_update_rate() * rehearse_time_step(io_));
    ticks_of_cycle_ = std::llround(ticks);
    if (ticks_of_cycle_ < 1 || std::abs(ticks - static_cast<double>(ticks_of_cycle_)) > 1e-6)
      throw std::runtime_error("a cycle of the controller_manager isn't a whole number of ticks: update_rate is " +
                               std::to_string(manager_->get_update_rate()) + " Hz");
  }

  /// Loads and configures it. Nothing waits for a cycle before the first one.
  void load(const std::string& name, const std::vector<std::string>& files) {
    if (!files.empty() && !manager_->has_parameter(name + ".params_file"))
      manager_->declare_parameter(name + ".params_file", files);
    if (!manager_->has_parameter(name + ".type"))
      if (const std::string type = type_in(files, name, full_name_of(name)); !type.empty())
        manager_->declare_parameter(name + ".type", type);
    const auto interface = manager_->load_controller(name);
    if (!interface) throw std::runtime_error("the controller '" + name + "' can't be loaded");
    open_library_of(*interface);
    if (manager_->configure_controller(name) != return_type::OK)
      throw std::runtime_error("the controller '" + name + "' can't be configured");
    controllers_.push_back({name, interface, interface->command_interface_configuration().names});
    robot_->choose_drives(name, controllers_.back().claimed);
    for (const auto& specification : manager_->get_loaded_controllers())
      if (specification.info.name == name)
        for (const std::string& fallback : specification.info.fallback_controllers_names)
          if (!is_loaded(fallback)) load(fallback, files);
  }

  void cycle() {
    const rclcpp::Time now = manager_->get_trigger_clock()->now();
    const rclcpp::Duration period = last_cycle_
                                        ? now - *last_cycle_
                                        : rclcpp::Duration::from_nanoseconds(
                                              1'000'000'000 / static_cast<std::int64_t>(manager_->get_update_rate()));
    last_cycle_ = now;
    for (Controller& controller : controllers_) controller.was_active = state_of(*controller.interface) == active;
    robot_->read();
    manager_->read(manager_->get_trigger_clock()->now(), period);
    const bool has_failed = manager_->update(manager_->get_trigger_clock()->now(), period) != return_type::OK;
    manager_->write(manager_->get_trigger_clock()->now(), period);
    if (has_failed) report_failed_controllers();
    if (const Robot::BadCommand bad = robot_->write(); !bad.problem.empty())
      throw std::runtime_error("the controller '" + controller_that_claims(bad.name) + "' " + bad.problem);
  }

  /// A controller whose update() fails ends the run, unless another one is to take over.
  void report_failed_controllers() const {
    std::vector<std::string> failed;
    const auto specifications = manager_->get_loaded_controllers();
    for (const Controller& controller : controllers_) {
      if (!controller.was_active || state_of(*controller.interface) == active) continue;
      const auto specification = std::find_if(specifications.begin(), specifications.end(),
                                              [&](const auto& other) { return other.info.name == controller.name; });
      if (specification == specifications.end() || specification->info.fallback_controllers_names.empty())
        failed.push_back(controller.name);
    }
    if (!failed.empty()) throw std::runtime_error("update() failed, so the manager deactivated " + listed(failed));
  }

  std::string controller_that_claims(const std::string& command) const {
    for (const Controller& controller : controllers_)
      if (state_of(*controller.interface) == active &&
          std::find(controller.claimed.begin(), controller.claimed.end(), command) != controller.claimed.end())
        return controller.name;
    return "?";
  }

  // In the order of their making: what is last goes first.
  rehearse_io* io_ = nullptr;
  std::optional<Robot> robot_;
  std::shared_ptr<rclcpp::executors::SingleThreadedExecutor> executor_;
  std::shared_ptr<controller_manager::ControllerManager> manager_;
  std::vector<Controller> controllers_;
  std::optional<Switch> switch_;
  long long ticks_of_cycle_ = 1;
  std::optional<rclcpp::Time> last_cycle_;
};

}  // namespace rehearse_ros2_control

RCLCPP_COMPONENTS_REGISTER_NODE(rehearse_ros2_control::ControllerManager)
