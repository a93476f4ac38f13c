// Parameters in files of YAML and on command lines, as the loader of ROS 2 reads them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rclcpp/parameter.hpp"

namespace rehearse_ros2 {

using Overrides = std::map<std::string, rclcpp::ParameterValue>;

/// True if the key of a file ("arm", "/left/arm", "/*/arm", "/**") names the node ("/left/arm").
bool key_names_node(std::string key, const std::string& node);

/// What stands behind --ros-args for one node.
struct NodeArguments {
  std::string name, space;  // after the remaps of both
  std::vector<std::pair<std::string, std::string>> remaps;
  Overrides overrides;
};
/// Lists of arguments, the later one counts. Throws RCLInvalidROSArgsError or UnknownROSArgsError.
NodeArguments read_arguments(std::string name, std::string space,
                             const std::vector<std::vector<std::string>>& arguments);
/// "/" and parts without a slash at the end.
std::string full_namespace(const std::string& space);
std::string full_name(const std::string& space, const std::string& name);

}  // namespace rehearse_ros2
