// Messages of any type as bytes: CDR, little endian, by the introspection of rosidl. One encoder for all types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <rosidl_runtime_c/message_type_support_struct.h>
#include <rosidl_typesupport_introspection_cpp/field_types.hpp>
#include <rosidl_typesupport_introspection_cpp/message_introspection.hpp>
#include <rosidl_typesupport_introspection_cpp/message_type_support_decl.hpp>

namespace rehearse_ros2 {

using MessageMembers = rosidl_typesupport_introspection_cpp::MessageMembers;

/// Of a type of C++.
template <class Message>
const MessageMembers& members_of() {
  const auto* support = rosidl_typesupport_introspection_cpp::get_message_type_support_handle<Message>();
  return *static_cast<const MessageMembers*>(support->data);
}

/// "geometry_msgs/msg/Twist"
std::string type_name_of(const MessageMembers& type);
/// Its definition as ros2msg: the fields, and those of all types that it uses. Constants are left out.
std::string definition_of(const MessageMembers& type);

/// A new message with its default values.
std::shared_ptr<void> make_message(const MessageMembers& type);

/// With the header of four bytes. A bounded sequence that is longer than its bound throws std::length_error.
void encode(const void* message, const MessageMembers& type, std::vector<std::uint8_t>& bytes);

/// The bytes are no message of the type.
class DecodingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// Sets the message, which make_message() made. The bytes may be anything: each length is compared with the bytes that
/// are left before memory is taken for it. Throws DecodingError.
void decode(const std::uint8_t* bytes, std::size_t size, const MessageMembers& type, void* message);

}  // namespace rehearse_ros2
