// A node as a component: a class of a library, which a host creates by its name.
#pragma once

#include <class_loader/class_loader.hpp>

#include <memory>
#include <utility>

#include <rclcpp/rclcpp.hpp>

namespace rclcpp_components {

class NodeInstanceWrapper {
 public:
  NodeInstanceWrapper() = default;
  NodeInstanceWrapper(std::shared_ptr<void> node, rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base)
      : node_(std::move(node)), base_(std::move(base)) {}
  const std::shared_ptr<void>& get_node_instance() const { return node_; }
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr get_node_base_interface() const { return base_; }

 private:
  std::shared_ptr<void> node_;
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base_;
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
    const auto node = std::make_shared<NodeType>(options);
    return {node, node->get_node_base_interface()};
  }
};

}  // namespace rclcpp_components

#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass) \
  CLASS_LOADER_REGISTER_CLASS(rclcpp_components::NodeFactoryTemplate<NodeClass>, rclcpp_components::NodeFactory)
