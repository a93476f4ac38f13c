// A node as a controller in C.
#pragma once

#include <rehearse/controller.h>

#include <memory>
#include <rclcpp_components/register_node_macro.hpp>

namespace rehearse::ros2 {

/// Makes the nodes of one class.
using NodeMaker = std::function<rclcpp_components::NodeInstanceWrapper(const rclcpp::NodeOptions&)>;

/// The functions whose next create() makes a guest with this node.
const rehearse_controller_functions* functions_of(NodeMaker maker);

}  // namespace rehearse::ros2
