// Messages of any type, by the introspection of rosidl.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <rosidl_runtime_c/message_type_support_struct.h>
#include <rosidl_typesupport_introspection_cpp/field_types.hpp>
#include <rosidl_typesupport_introspection_cpp/message_introspection.hpp>
#include <rosidl_typesupport_introspection_cpp/message_type_support_decl.hpp>

namespace rehearse_ros2 {

using MessageMembers = rosidl_typesupport_introspection_cpp::MessageMembers;
using MessageMember = rosidl_typesupport_introspection_cpp::MessageMember;

/// Of a type of C++.
template <class Message>
const MessageMembers& members_of() {
  const auto* support = rosidl_typesupport_introspection_cpp::get_message_type_support_handle<Message>();
  return *static_cast<const MessageMembers*>(support->data);
}
/// Of the messages in a field.
inline const MessageMembers& members_in(const MessageMember& field) {
  return *static_cast<const MessageMembers*>(field.members_->data);
}

/// "geometry_msgs/msg/Twist"
std::string type_name_of(const MessageMembers& type);

/// A new message with its default values.
std::shared_ptr<void> make_message(const MessageMembers& type);

/// Null: the type has no such field.
const MessageMember* field_named(const MessageMembers& type, const std::string& name);

/// Where the field of a message is.
inline const void* place_of(const void* message, const MessageMember& field) {
  return static_cast<const char*>(message) + field.offset_;
}
inline void* place_of(void* message, const MessageMember& field) { return static_cast<char*>(message) + field.offset_; }

/// The number of elements of an array at that place.
inline std::size_t count_of(const void* place, const MessageMember& field) {
  return field.size_function != nullptr ? field.size_function(place) : field.array_size_;
}

}  // namespace rehearse_ros2
