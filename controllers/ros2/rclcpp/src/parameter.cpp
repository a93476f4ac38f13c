#include "rclcpp/parameter.hpp"

#include <sstream>

namespace rclcpp {
namespace {

constexpr const char* type_names[] = {"not set",    "bool",       "integer",       "double",       "string",
                                      "byte_array", "bool_array", "integer_array", "double_array", "string_array"};

std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const std::string& value) { return "\"" + value + "\""; }
template <class Number>
std::string text_of(Number value) {
  return std::to_string(value);
}
template <class Element>
std::string text_of(const std::vector<Element>& values) {
  std::string text = "[";
  for (const auto& value : values) text += (text.size() > 1 ? ", " : "") + text_of(static_cast<Element>(value));
  return text + "]";
}

/// Calls `use` with the member of the message that has the value of this type; nothing if it isn't set.
template <class Message, class Use>
void with_member(Message& message, std::uint8_t type, Use use) {
  switch (type) {
    case PARAMETER_BOOL: return use(message.bool_value);
    case PARAMETER_INTEGER: return use(message.integer_value);
    case PARAMETER_DOUBLE: return use(message.double_value);
    case PARAMETER_STRING: return use(message.string_value);
    case PARAMETER_BYTE_ARRAY: return use(message.byte_array_value);
    case PARAMETER_BOOL_ARRAY: return use(message.bool_array_value);
    case PARAMETER_INTEGER_ARRAY: return use(message.integer_array_value);
    case PARAMETER_DOUBLE_ARRAY: return use(message.double_array_value);
    case PARAMETER_STRING_ARRAY: return use(message.string_array_value);
    default: return;
  }
}

}  // namespace

std::string to_string(ParameterType type) { return type <= PARAMETER_STRING_ARRAY ? type_names[type] : "unknown type"; }
std::ostream& operator<<(std::ostream& out, ParameterType type) { return out << to_string(type); }

ParameterValue::ParameterValue(const rcl_interfaces::msg::ParameterValue& message) {
  if (message.type > PARAMETER_STRING_ARRAY) throw std::runtime_error("unknown type of a parameter");
  with_member(message, message.type, [this](const auto& value) { value_ = std::decay_t<decltype(value)>(value); });
}

rcl_interfaces::msg::ParameterValue ParameterValue::to_value_msg() const {
  rcl_interfaces::msg::ParameterValue message;
  message.type = get_type();
  with_member(message, message.type, [this](auto& place) { place = std::get<std::decay_t<decltype(place)>>(value_); });
  return message;
}

std::string to_string(const ParameterValue& value) {
  if (value.get_type() == PARAMETER_STRING) return value.get<PARAMETER_STRING>();
  std::string text = "not set";
  const rcl_interfaces::msg::ParameterValue message = value.to_value_msg();
  with_member(message, message.type, [&](const auto& member) { text = text_of(member); });
  return text;
}

rcl_interfaces::msg::Parameter Parameter::to_parameter_msg() const {
  rcl_interfaces::msg::Parameter message;
  message.name = name_;
  message.value = value_.to_value_msg();
  return message;
}

std::string to_string(const Parameter& parameter) { return parameter.value_to_string(); }
std::ostream& operator<<(std::ostream& out, const Parameter& parameter) { return out << parameter.value_to_string(); }
std::string _to_json_dict_entry(const Parameter& parameter) {
  return "\"" + parameter.get_name() + "\": {\"type\": \"" + parameter.get_type_name() + "\", \"value\": \"" +
         parameter.value_to_string() + "\"}";
}

}  // namespace rclcpp
