// Numbers and texts in messages of any type.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <rclcpp/detail/message_type.hpp>
#include <stdexcept>
#include <string>

namespace rehearse::ros2 {

/// A mistake in the options of a guest; what() is a sentence for its author.
class OptionsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sets the fields that the map states. Throws OptionsError, which names the line.
void set_fields(void* message, const rehearse_ros2::MessageMembers& type, const YAML::Node& fields);

/// Calls `use` with the name ("pose/position/x", "data/0") and the value of each number of the message except times, of
/// arrays at most of the first 64 elements.
void for_each_number(const void* message, const rehearse_ros2::MessageMembers& type,
                     const std::function<void(const std::string& name, double value)>& use);

/// "options, line 3: text", with the line of the node.
OptionsError mistake(const YAML::Node& node, const std::string& text);

}  // namespace rehearse::ros2
