// A node as a component: a class of a library, which a host creates by its name.
#pragma once

#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rclcpp_components/rehearse_driver.hpp"

namespace rclcpp_components {

class NodeInstanceWrapper {
 public:
  NodeInstanceWrapper() = default;
  NodeInstanceWrapper(std::shared_ptr<void> node, rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base)
      : node_(std::move(node)), base_(std::move(base)) {}
  explicit NodeInstanceWrapper(std::shared_ptr<rehearse_ros2::RobotDriver> driver) : driver_(std::move(driver)) {}
  const std::shared_ptr<void>& get_node_instance() const { return node_; }
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr get_node_base_interface() const { return base_; }
  /// Null: it is a node.
  const std::shared_ptr<rehearse_ros2::RobotDriver>& rehearse_driver() const { return driver_; }

 private:
  std::shared_ptr<void> node_;
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base_;
  std::shared_ptr<rehearse_ros2::RobotDriver> driver_;
};

class NodeFactory {
 public:
  NodeFactory() = default;
  virtual ~NodeFactory() = default;
  virtual NodeInstanceWrapper create_node_instance(const rclcpp::NodeOptions& options) = 0;
};

template <class NodeType>
class NodeFactoryTemplate : public NodeFactory {
 public:
  NodeInstanceWrapper create_node_instance(const rclcpp::NodeOptions& options) override {
    if constexpr (std::is_base_of_v<rehearse_ros2::RobotDriver, NodeType>) {
      (void)options;  // a driver takes its own ones
      return NodeInstanceWrapper(std::make_shared<NodeType>());
    } else {
      const auto node = std::make_shared<NodeType>(options);
      return {node, node->get_node_base_interface()};
    }
  }
};

using RehearseMaker = std::unique_ptr<NodeFactory> (*)();

/// A component of the library that contains this object, as long as it is loaded. Two libraries may have components of
/// one name.
class RehearseComponent {
 public:
  RehearseComponent(const char* name, RehearseMaker maker);
  ~RehearseComponent();
  RehearseComponent(const RehearseComponent&) = delete;
  RehearseComponent& operator=(const RehearseComponent&) = delete;
};

/// Makes the component of a library; null: it has none of that name. `handle`: of the dynamic linker.
RehearseMaker rehearse_find_component(void* handle, const std::string& name);
/// The names of all components of a library.
std::vector<std::string> rehearse_components_of(void* handle);

}  // namespace rclcpp_components

#define REHEARSE_COMPONENT_NAME_(number) rehearse_component_##number
#define REHEARSE_COMPONENT_NAME(number) REHEARSE_COMPONENT_NAME_(number)
#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass)                                      \
  namespace {                                                                           \
  const ::rclcpp_components::RehearseComponent REHEARSE_COMPONENT_NAME(__COUNTER__){    \
      #NodeClass, []() -> std::unique_ptr<::rclcpp_components::NodeFactory> {           \
        return std::make_unique<::rclcpp_components::NodeFactoryTemplate<NodeClass>>(); \
      }};                                                                               \
  }
