// The components of hardware: they stand in for those that a description names.
#include <hardware_interface/actuator_interface.hpp>
#include <hardware_interface/sensor_interface.hpp>
#include <hardware_interface/system_interface.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "robot.h"

namespace rehearse_ros2_control {

using hardware_interface::return_type;

/// Shows the states of the robot. An interface that the robot doesn't have keeps its first value, or follows the
/// command of its name.
template <class Interface>
class Reader : public Interface {
 public:
  hardware_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    states_.clear();
    followers_.clear();
    for (const auto* parts : {&this->info_.joints, &this->info_.sensors, &this->info_.gpios})
      for (const hardware_interface::ComponentInfo& part : *parts)
        for (const hardware_interface::InterfaceInfo& interface : part.state_interfaces) add(part, interface.name);
    return hardware_interface::CallbackReturn::SUCCESS;
  }
  return_type read(const rclcpp::Time&, const rclcpp::Duration&) override {
    for (const Value& state : states_) this->set_state(state.name, robot_.value_of(state.index));
    for (const std::string& name : followers_) this->set_state(name, this->get_command(name));
    return return_type::OK;
  }

 protected:
  struct Value {
    std::string name;
    std::size_t index;  // of the robot's states or commands
  };
  Robot& robot_ = *Robot::being_made();

 private:
  void add(const hardware_interface::ComponentInfo& part, const std::string& interface) {
    const std::string name = part.name + "/" + interface;
    const std::size_t index = robot_.state(part.name, interface);
    if (index != Robot::none) {
      states_.push_back({name, index});
      return;
    }
    bool follows = false;
    for (const hardware_interface::InterfaceInfo& command : part.command_interfaces)
      follows |= command.name == interface;
    if (follows) followers_.push_back(name);
    RCLCPP_WARN(rclcpp::get_logger("rehearse_ros2_control"), "the robot has no '%s': it %s", name.c_str(),
                follows ? "follows its command" : "keeps its first value");
  }
  std::vector<Value> states_;
  std::vector<std::string> followers_;
};

/// Passes commands on, too.
template <class Interface>
class Writer : public Reader<Interface> {
 public:
  hardware_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override {
    commands_.clear();
    for (const hardware_interface::ComponentInfo& joint : this->info_.joints)
      for (const hardware_interface::InterfaceInfo& interface : joint.command_interfaces)
        if (const std::size_t index = this->robot_.command(joint.name, interface.name); index != Robot::none)
          commands_.push_back({joint.name + "/" + interface.name, index});
    return Reader<Interface>::on_configure(state);
  }
  return_type perform_command_mode_switch(const std::vector<std::string>& start,
                                          const std::vector<std::string>& stop) override {
    this->robot_.claim(stop, false);
    this->robot_.claim(start, true);
    return return_type::OK;
  }
  return_type write(const rclcpp::Time&, const rclcpp::Duration&) override {
    for (const auto& command : commands_) this->robot_.set(command.index, this->get_command(command.name));
    return return_type::OK;
  }

 private:
  std::vector<typename Reader<Interface>::Value> commands_;
};

class Actuator final : public Writer<hardware_interface::ActuatorInterface> {};
class Sensor final : public Reader<hardware_interface::SensorInterface> {};
class System final : public Writer<hardware_interface::SystemInterface> {};

}  // namespace rehearse_ros2_control

PLUGINLIB_EXPORT_CLASS(rehearse_ros2_control::Actuator, hardware_interface::ActuatorInterface)
PLUGINLIB_EXPORT_CLASS(rehearse_ros2_control::Sensor, hardware_interface::SensorInterface)
PLUGINLIB_EXPORT_CLASS(rehearse_ros2_control::System, hardware_interface::SystemInterface)
