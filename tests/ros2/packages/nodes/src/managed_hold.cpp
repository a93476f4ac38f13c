// Pushes the hinge with one torque while it is active.
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

namespace test_nodes {

class ManagedHold : public rclcpp_lifecycle::LifecycleNode {
 public:
  explicit ManagedHold(const rclcpp::NodeOptions& options) : LifecycleNode("managed", options) {}
  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    commands_ = create_publisher<sensor_msgs::msg::JointState>("/commands", 1);
    states_ = create_subscription<sensor_msgs::msg::JointState>("/joint_states", 1,
                                                                [this](sensor_msgs::msg::JointState::UniquePtr state) {
                                                                  sensor_msgs::msg::JointState command;
                                                                  command.name = state->name;
                                                                  command.effort.assign(state->name.size(), 2.0);
                                                                  commands_->publish(command);
                                                                });
    return CallbackReturn::SUCCESS;
  }

 private:
  rclcpp_lifecycle::LifecyclePublisher<sensor_msgs::msg::JointState>::SharedPtr commands_;
  rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr states_;
};

}  // namespace test_nodes

RCLCPP_COMPONENTS_REGISTER_NODE(test_nodes::ManagedHold)
