// Holds the hinge of a pendulum at an angle: parameters, a timer, a service, an action and transforms.
#include <chrono>
#include <cmath>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <tf2_msgs/action/lookup_transform.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vector>

#ifndef STIFFNESS
#define STIFFNESS 40.0
#endif

namespace test_nodes {

using Turn = tf2_msgs::action::LookupTransform;
using TurnHandle = rclcpp_action::ServerGoalHandle<Turn>;

class Hold : public rclcpp::Node {
 public:
  explicit Hold(const rclcpp::NodeOptions& options) : Node("hold", options) {
    stiffness_ = declare_parameter("stiffness", STIFFNESS);  // [N·m/rad]
    damping_ = declare_parameter("damping", 6.0);            // [N·m·s/rad]
    target_ = declare_parameter("target", 0.5);              // [rad]
    on_set_ = add_on_set_parameters_callback([this](const std::vector<rclcpp::Parameter>& parameters) {
      rcl_interfaces::msg::SetParametersResult result;
      result.successful = true;
      for (const auto& parameter : parameters) {
        if (parameter.get_name() == "stiffness") stiffness_ = parameter.as_double();
        if (parameter.get_name() == "target") target_ = parameter.as_double();
      }
      return result;
    });
    efforts_ = create_publisher<std_msgs::msg::Float64MultiArray>("/efforts", 1);
    angle_ = create_publisher<std_msgs::msg::Float64>("~/angle", 10);
    transforms_ = create_publisher<tf2_msgs::msg::TFMessage>("/tf", 100);
    states_ = create_subscription<sensor_msgs::msg::JointState>(
        "/joint_states", rclcpp::SystemDefaultsQoS(),
        [this](sensor_msgs::msg::JointState::ConstSharedPtr state) { command(*state); });
    targets_ = create_subscription<std_msgs::msg::Float64>(
        "~/target", 1, [this](const std_msgs::msg::Float64& message) { target_ = message.data; });
    rest_ = create_service<std_srvs::srv::Trigger>(
        "~/rest",
        [this](std_srvs::srv::Trigger::Request::SharedPtr, std_srvs::srv::Trigger::Response::SharedPtr response) {
          target_ = 0.0;
          response->success = true;
          RCLCPP_INFO(get_logger(), "rests at %.1f rad", target_);
        });
    timer_ = create_wall_timer(std::chrono::milliseconds(10), [this] {
      std_msgs::msg::Float64 message;
      message.data = q_;
      angle_->publish(message);
      tf2_msgs::msg::TFMessage transforms;
      transforms.transforms.resize(1);
      auto& transform = transforms.transforms[0];
      transform.header.stamp = now();
      transform.header.frame_id = "world";
      transform.child_frame_id = "rod";
      transform.transform.rotation.y = std::sin(q_ / 2.0);
      transform.transform.rotation.w = std::cos(q_ / 2.0);
      transforms_->publish(transforms);
    });
    server_ = rclcpp_action::create_server<Turn>(
        this, "~/turn",
        [](const rclcpp_action::GoalUUID&, std::shared_ptr<const Turn::Goal>) {
          return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [](std::shared_ptr<TurnHandle>) { return rclcpp_action::CancelResponse::ACCEPT; },
        [this](std::shared_ptr<TurnHandle> handle) {
          target_ = -0.3;
          handle->succeed(std::make_shared<Turn::Result>());
        });
  }

 private:
  void command(const sensor_msgs::msg::JointState& state) {
    q_ = state.position.at(0);
    std_msgs::msg::Float64MultiArray message;
    message.data.push_back(stiffness_ * (target_ - q_) - damping_ * state.velocity.at(0));
    efforts_->publish(message);
    RCLCPP_INFO_THROTTLE(get_logger(), *get_clock(), 500, "at %.3f rad", q_);
  }

  double stiffness_ = 0.0, damping_ = 0.0, target_ = 0.0, q_ = 0.0;
  OnSetParametersCallbackHandle::SharedPtr on_set_;
  rclcpp::Publisher<std_msgs::msg::Float64MultiArray>::SharedPtr efforts_;
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr angle_;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr transforms_;
  rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr states_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr targets_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr rest_;
  rclcpp::TimerBase::SharedPtr timer_;
  rclcpp_action::Server<Turn>::SharedPtr server_;
};

}  // namespace test_nodes

RCLCPP_COMPONENTS_REGISTER_NODE(test_nodes::Hold)
