// Schemas in other languages than that of ROS 2 messages, as the same Schema. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>
#include <string_view>

#include "ros2msg.h"

namespace rehearse::ros2msg {

/// Definitions of ROS 1. time and duration become builtin_interfaces/Time and Duration; constants are left out.
Result<Schema> parse_ros1(std::string_view type, std::string_view text, std::string file);

/// Definitions in OMG IDL, as rosidl writes them: sections that begin with a line of '=' and "IDL: package/msg/Name".
Result<Schema> parse_idl(std::string_view type, std::string_view text, std::string file);

/// A JSON Schema of objects. Properties whose type isn't stated, or is one of several, are left out.
Result<Schema> parse_json_schema(std::string_view type, std::string_view text, std::string file);

/// A FileDescriptorSet of protobuf. Groups, and messages that contain themselves, are left out.
Result<Schema> parse_protobuf(std::string_view type, std::string_view text, std::string file);

}  // namespace rehearse::ros2msg
