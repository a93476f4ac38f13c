// The fields of the message types of ROS 2's standard packages, for logs that don't contain them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rehearse::bag {

/// The complete ros2msg text of a type, as sensor_msgs/msg/JointState: its fields, then each type that it uses under
/// its own heading. Constants are left out. nullopt: the type isn't one of the standard packages.
std::optional<std::string> standard_definition(std::string_view type);

}  // namespace rehearse::bag
