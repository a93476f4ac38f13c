// A controller whose command grows, until it fails as its parameter `failure` says.
#include <controller_interface/controller_interface.hpp>
#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>

namespace test_controllers {

using controller_interface::interface_configuration_type;
using controller_interface::return_type;

class Failing final : public controller_interface::ControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override {
    auto_declare<std::string>("failure", "");
    return controller_interface::CallbackReturn::SUCCESS;
  }
  controller_interface::InterfaceConfiguration command_interface_configuration() const override {
    return {interface_configuration_type::INDIVIDUAL, {"J1/position"}};
  }
  controller_interface::InterfaceConfiguration state_interface_configuration() const override {
    return {interface_configuration_type::NONE, {}};
  }
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    failure_ = get_node()->get_parameter("failure").as_string();
    return controller_interface::CallbackReturn::SUCCESS;
  }
  return_type update(const rclcpp::Time&, const rclcpp::Duration& period) override {
    angle_ += 0.1 * period.seconds();
    double command = angle_;
    if (++cycles_ >= 50 && failure_ == "error") return return_type::ERROR;
    if (cycles_ >= 50 && failure_ == "exception") throw std::runtime_error("the arm is cold");
    if (cycles_ >= 50 && failure_ == "nan") command = std::numeric_limits<double>::quiet_NaN();
    (void)command_interfaces_[0].set_value(command);
    return return_type::OK;
  }

 private:
  std::string failure_;
  double angle_ = 0.0;  // [rad]
  int cycles_ = 0;
};

}  // namespace test_controllers

PLUGINLIB_EXPORT_CLASS(test_controllers::Failing, controller_interface::ControllerInterface)
