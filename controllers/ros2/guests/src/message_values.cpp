#include "message_values.h"

#include <algorithm>
#include <cstring>
#include <optional>

namespace rehearse::ros2 {
namespace {

namespace introspection = rosidl_typesupport_introspection_cpp;
using rehearse_ros2::members_in;
using rehearse_ros2::MessageMember;
using rehearse_ros2::MessageMembers;
using rehearse_ros2::place_of;

/// Calls `use` with a value of the type of the number; false: it is no number.
template <class Use>
bool with_number_type(std::uint8_t type, Use use) {
  switch (type) {
    case introspection::ROS_TYPE_FLOAT: return use(float{}), true;
    case introspection::ROS_TYPE_DOUBLE: return use(double{}), true;
    case introspection::ROS_TYPE_BOOLEAN: return use(bool{}), true;
    case introspection::ROS_TYPE_CHAR:
    case introspection::ROS_TYPE_OCTET:
    case introspection::ROS_TYPE_UINT8: return use(std::uint8_t{}), true;
    case introspection::ROS_TYPE_INT8: return use(std::int8_t{}), true;
    case introspection::ROS_TYPE_UINT16: return use(std::uint16_t{}), true;
    case introspection::ROS_TYPE_INT16: return use(std::int16_t{}), true;
    case introspection::ROS_TYPE_UINT32: return use(std::uint32_t{}), true;
    case introspection::ROS_TYPE_INT32: return use(std::int32_t{}), true;
    case introspection::ROS_TYPE_UINT64: return use(std::uint64_t{}), true;
    case introspection::ROS_TYPE_INT64: return use(std::int64_t{}), true;
    default: return false;
  }
}

template <class Number>
Number number_of(const YAML::Node& node) {
  try {
    if constexpr (sizeof(Number) == 1 && !std::is_same_v<Number, bool>) {
      const int value = node.as<int>();
      if (value < std::numeric_limits<Number>::min() || value > std::numeric_limits<Number>::max())
        throw mistake(node, "'" + node.Scalar() + "' doesn't fit");
      return static_cast<Number>(value);
    } else {
      return node.as<Number>();
    }
  } catch (const YAML::Exception&) {
    throw mistake(node, node.IsScalar() ? "'" + node.Scalar() + "' is no value of this field"
                                        : std::string("expected one value for this field"));
  }
}

void set_value(void* place, const MessageMember& member, const YAML::Node& node) {
  if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) return set_fields(place, members_in(member), node);
  if (member.type_id_ == introspection::ROS_TYPE_STRING) {
    if (!node.IsScalar()) throw mistake(node, std::string("'") + member.name_ + "' is a text");
    *static_cast<std::string*>(place) = node.Scalar();
    return;
  }
  const bool is_number = with_number_type(
      member.type_id_, [&](auto type) { *static_cast<decltype(type)*>(place) = number_of<decltype(type)>(node); });
  if (!is_number) throw mistake(node, std::string("'") + member.name_ + "' can't be stated here");
}

void set_member(void* message, const MessageMember& member, const YAML::Node& node) {
  void* const place = place_of(message, member);
  if (!member.is_array_) return set_value(place, member, node);
  if (!node.IsSequence()) throw mistake(node, std::string("'") + member.name_ + "' is a list");
  const bool is_fixed = member.array_size_ != 0 && !member.is_upper_bound_;
  if (member.array_size_ != 0 && (is_fixed ? node.size() != member.array_size_ : node.size() > member.array_size_))
    throw mistake(node, std::string("'") + member.name_ + "' has " + std::to_string(member.array_size_) + " elements");
  if (!is_fixed) member.resize_function(place, node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN) {
      const bool element = number_of<bool>(node[i]);
      member.assign_function(place, i, &element);
    } else {
      set_value(member.get_function(place, i), member, node[i]);
    }
  }
}

constexpr std::size_t most_elements = 64;

void add_numbers(const void* message, const MessageMembers& type, const std::string& prefix,
                 const std::function<void(const std::string&, double)>& use) {
  for (std::uint32_t i = 0; i < type.member_count_; ++i) {
    const MessageMember& member = type.members_[i];
    const void* const place = place_of(message, member);
    const std::size_t count = member.is_array_ ? std::min(rehearse_ros2::count_of(place, member), most_elements) : 1;
    for (std::size_t element = 0; element < count; ++element) {
      const std::string name = prefix + member.name_ + (member.is_array_ ? "/" + std::to_string(element) : "");
      if (member.is_array_ && member.type_id_ == introspection::ROS_TYPE_BOOLEAN) {
        bool value = false;
        member.fetch_function(place, element, &value);
        use(name, value ? 1.0 : 0.0);
        continue;
      }
      const void* const at = member.is_array_ ? member.get_const_function(place, element) : place;
      if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) {
        if (rehearse_ros2::type_name_of(members_in(member)) == "builtin_interfaces/msg/Time") continue;
        add_numbers(at, members_in(member), name + "/", use);
        continue;
      }
      with_number_type(member.type_id_, [&](auto number) {
        std::memcpy(&number, at, sizeof number);
        use(name, static_cast<double>(number));
      });
    }
  }
}

}  // namespace

OptionsError mistake(const YAML::Node& node, const std::string& text) {
  return OptionsError("options, line " + std::to_string(node.Mark().line + 1) + ": " + text);
}

void set_fields(void* message, const MessageMembers& type, const YAML::Node& fields) {
  if (!fields.IsMap()) throw mistake(fields, rehearse_ros2::type_name_of(type) + " is a map of fields");
  for (const auto& entry : fields) {
    const std::string name = entry.first.Scalar();
    const MessageMember* const member = rehearse_ros2::field_named(type, name);
    if (member == nullptr)
      throw mistake(entry.first, rehearse_ros2::type_name_of(type) + " has no field '" + name + "'");
    set_member(message, *member, entry.second);
  }
}

void for_each_number(const void* message, const MessageMembers& type,
                     const std::function<void(const std::string&, double)>& use) {
  add_numbers(message, type, "", use);
}

}  // namespace rehearse::ros2
