#include "rclcpp/detail/message_type.hpp"

namespace rehearse_ros2 {

std::string type_name_of(const MessageMembers& type) {
  std::string space = type.message_namespace_;
  for (std::size_t at = space.find("::"); at != std::string::npos; at = space.find("::", at)) space.replace(at, 2, "/");
  return space + "/" + type.message_name_;
}

std::shared_ptr<void> make_message(const MessageMembers& type) {
  void* const memory = ::operator new(type.size_of_);
  try {
    type.init_function(memory, rosidl_runtime_cpp::MessageInitialization::ALL);
  } catch (...) {
    ::operator delete(memory);
    throw;
  }
  return std::shared_ptr<void>(memory, [&type](void* message) {
    type.fini_function(message);
    ::operator delete(message);
  });
}

const MessageMember* field_named(const MessageMembers& type, const std::string& name) {
  for (std::uint32_t i = 0; i < type.member_count_; ++i)
    if (type.members_[i].name_ == name) return &type.members_[i];
  return nullptr;
}

}  // namespace rehearse_ros2
