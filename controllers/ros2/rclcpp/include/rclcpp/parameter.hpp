// Parameters and their values.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include <rcl_interfaces/msg/list_parameters_result.hpp>
#include <rcl_interfaces/msg/parameter.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/parameter_event.hpp>
#include <rcl_interfaces/msg/parameter_type.hpp>
#include <rcl_interfaces/msg/parameter_value.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>

#include "rclcpp/exceptions.hpp"
#include "rclcpp/macros.hpp"

namespace rclcpp {

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET = rcl_interfaces::msg::ParameterType::PARAMETER_NOT_SET,
  PARAMETER_BOOL = rcl_interfaces::msg::ParameterType::PARAMETER_BOOL,
  PARAMETER_INTEGER = rcl_interfaces::msg::ParameterType::PARAMETER_INTEGER,
  PARAMETER_DOUBLE = rcl_interfaces::msg::ParameterType::PARAMETER_DOUBLE,
  PARAMETER_STRING = rcl_interfaces::msg::ParameterType::PARAMETER_STRING,
  PARAMETER_BYTE_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_BYTE_ARRAY,
  PARAMETER_BOOL_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_BOOL_ARRAY,
  PARAMETER_INTEGER_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_INTEGER_ARRAY,
  PARAMETER_DOUBLE_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_DOUBLE_ARRAY,
  PARAMETER_STRING_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_STRING_ARRAY,
};

std::string to_string(ParameterType type);
std::ostream& operator<<(std::ostream& out, ParameterType type);

class ParameterTypeException : public std::runtime_error {
 public:
  ParameterTypeException(ParameterType expected, ParameterType actual)
      : std::runtime_error("expected [" + to_string(expected) + "] got [" + to_string(actual) + "]") {}
};

namespace detail {

template <class Value>
struct VectorOf : std::false_type {
  using Element = void;
};
template <class Element_>
struct VectorOf<std::vector<Element_>> : std::true_type {
  using Element = Element_;
};

/// The type of a parameter that holds a value of this type of C++; PARAMETER_NOT_SET: none does.
template <class Value>
constexpr ParameterType parameter_type_of() {
  using Element = typename VectorOf<Value>::Element;
  if constexpr (std::is_same_v<Value, bool>)
    return PARAMETER_BOOL;
  else if constexpr (std::is_integral_v<Value>)
    return PARAMETER_INTEGER;
  else if constexpr (std::is_floating_point_v<Value>)
    return PARAMETER_DOUBLE;
  else if constexpr (std::is_convertible_v<Value, std::string>)
    return PARAMETER_STRING;
  else if constexpr (std::is_same_v<Element, std::uint8_t>)
    return PARAMETER_BYTE_ARRAY;
  else if constexpr (std::is_same_v<Element, bool>)
    return PARAMETER_BOOL_ARRAY;
  else if constexpr (std::is_integral_v<Element> &&
                     sizeof(std::conditional_t<std::is_void_v<Element>, int, Element>) >= 4)
    return PARAMETER_INTEGER_ARRAY;
  else if constexpr (std::is_floating_point_v<Element>)
    return PARAMETER_DOUBLE_ARRAY;
  else if constexpr (std::is_same_v<Element, std::string>)
    return PARAMETER_STRING_ARRAY;
  else
    return PARAMETER_NOT_SET;
}
template <class Value>
constexpr bool is_parameter = parameter_type_of<Value>() != PARAMETER_NOT_SET;

using ParameterVariant =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::uint8_t>, std::vector<bool>,
                 std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>>;
template <ParameterType type>
using StoredParameter = std::variant_alternative_t<type, ParameterVariant>;

}  // namespace detail

class ParameterValue {
 public:
  ParameterValue() = default;
  explicit ParameterValue(const rcl_interfaces::msg::ParameterValue& message);
  template <class Value, class = std::enable_if_t<detail::is_parameter<Value>>>
  explicit ParameterValue(const Value& value) {
    using Stored = detail::StoredParameter<detail::parameter_type_of<Value>()>;
    if constexpr (detail::VectorOf<Value>::value && !std::is_same_v<Stored, Value>)
      value_ = Stored(value.begin(), value.end());
    else
      value_ = static_cast<Stored>(value);
  }
  explicit ParameterValue(const char* text) : value_(std::string(text)) {}

  ParameterType get_type() const { return static_cast<ParameterType>(value_.index()); }
  rcl_interfaces::msg::ParameterValue to_value_msg() const;
  bool operator==(const ParameterValue& other) const { return value_ == other.value_; }
  bool operator!=(const ParameterValue& other) const { return value_ != other.value_; }

  /// Throws ParameterTypeException if it is of another type.
  template <ParameterType type>
  const detail::StoredParameter<type>& get() const {
    if (get_type() != type) throw ParameterTypeException(type, get_type());
    return std::get<type>(value_);
  }
  template <class Value>
  decltype(auto) get() const {
    constexpr ParameterType type = detail::parameter_type_of<Value>();
    static_assert(type != PARAMETER_NOT_SET, "no parameter has values of this type");
    using Stored = detail::StoredParameter<type>;
    if constexpr (std::is_same_v<Stored, Value>) {
      return static_cast<const Value&>(get<type>());
    } else if constexpr (detail::VectorOf<Value>::value) {
      return Value(get<type>().begin(), get<type>().end());
    } else {
      return static_cast<Value>(get<type>());
    }
  }

 private:
  detail::ParameterVariant value_;
};

std::string to_string(const ParameterValue& value);

class Parameter {
  template <class Get>
  decltype(auto) named(Get get) const {
    try {
      return get();
    } catch (const ParameterTypeException& wrong) {
      throw exceptions::InvalidParameterTypeException(name_, wrong.what());
    }
  }

 public:
  Parameter() = default;
  explicit Parameter(const std::string& name) : name_(name) {}
  Parameter(const std::string& name, const ParameterValue& value) : name_(name), value_(value) {}
  template <class Value, class = std::enable_if_t<detail::is_parameter<std::decay_t<Value>> &&
                                                  !std::is_same_v<std::decay_t<Value>, ParameterValue>>>
  Parameter(const std::string& name, Value&& value) : name_(name) {
    if constexpr (std::is_convertible_v<Value, std::string>)
      value_ = ParameterValue(std::string(std::forward<Value>(value)));
    else
      value_ = ParameterValue(std::decay_t<Value>(std::forward<Value>(value)));
  }
  explicit Parameter(const rcl_interfaces::msg::Parameter& message) : name_(message.name), value_(message.value) {}

  bool operator==(const Parameter& other) const { return name_ == other.name_ && value_ == other.value_; }
  bool operator!=(const Parameter& other) const { return !(*this == other); }
  ParameterType get_type() const { return value_.get_type(); }
  std::string get_type_name() const { return to_string(get_type()); }
  const std::string& get_name() const { return name_; }
  const ParameterValue& get_parameter_value() const { return value_; }
  rcl_interfaces::msg::ParameterValue get_value_message() const { return value_.to_value_msg(); }
  /// Throw exceptions::InvalidParameterTypeException, which names the parameter, if it is of another type.
  template <ParameterType type>
  decltype(auto) get_value() const {
    return named([this]() -> decltype(auto) { return value_.template get<type>(); });
  }
  template <class Value>
  decltype(auto) get_value() const {
    return named([this]() -> decltype(auto) { return value_.template get<Value>(); });
  }
  bool as_bool() const { return get_value<PARAMETER_BOOL>(); }
  std::int64_t as_int() const { return get_value<PARAMETER_INTEGER>(); }
  double as_double() const { return get_value<PARAMETER_DOUBLE>(); }
  const std::string& as_string() const { return get_value<PARAMETER_STRING>(); }
  const std::vector<std::uint8_t>& as_byte_array() const { return get_value<PARAMETER_BYTE_ARRAY>(); }
  const std::vector<bool>& as_bool_array() const { return get_value<PARAMETER_BOOL_ARRAY>(); }
  const std::vector<std::int64_t>& as_integer_array() const { return get_value<PARAMETER_INTEGER_ARRAY>(); }
  const std::vector<double>& as_double_array() const { return get_value<PARAMETER_DOUBLE_ARRAY>(); }
  const std::vector<std::string>& as_string_array() const { return get_value<PARAMETER_STRING_ARRAY>(); }
  static Parameter from_parameter_msg(const rcl_interfaces::msg::Parameter& message) { return Parameter(message); }
  rcl_interfaces::msg::Parameter to_parameter_msg() const;
  std::string value_to_string() const { return to_string(value_); }

 private:
  std::string name_;
  ParameterValue value_;
};

std::string to_string(const Parameter& parameter);
std::ostream& operator<<(std::ostream& out, const Parameter& parameter);
std::string _to_json_dict_entry(const Parameter& parameter);

using ParameterMap = std::unordered_map<std::string, std::vector<Parameter>>;
/// The parameters of a YAML file by the names of nodes in it, wildcards as they are. Throws RCLInvalidROSArgsError.
ParameterMap parameter_map_from_yaml_file(const std::string& file, const char* node = nullptr);
/// Those of one node, wildcards included; keys that match better come last.
std::vector<Parameter> parameters_from_map(const ParameterMap& map, const char* node);

}  // namespace rclcpp

namespace rehearse_ros2 {

/// The value of a text on a command line, as "2.5" or "[a, b]". Throws RCLInvalidROSArgsError.
rclcpp::ParameterValue value_of_text(const std::string& text);

}  // namespace rehearse_ros2
