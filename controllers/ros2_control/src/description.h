// The description of a robot, for its controllers.
#pragma once

#include <string>

namespace rehearse_ros2_control {

/// The text of a file of URDF in which each <ros2_control> names the component of this library in place of its own
/// plugin, which is never loaded. Throws std::runtime_error.
std::string read_description(const std::string& file);

}  // namespace rehearse_ros2_control
