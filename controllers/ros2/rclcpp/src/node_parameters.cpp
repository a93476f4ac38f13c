#include "node_parameters.h"

#include <algorithm>
#include <cmath>

namespace rehearse_ros2 {
namespace {

using rclcpp::Parameter;
using rclcpp::ParameterType;
using rclcpp::ParameterValue;
using Descriptor = NodeParameters::Descriptor;
using Result = NodeParameters::Result;
namespace exceptions = rclcpp::exceptions;

Result accepted() {
  Result result;
  result.successful = true;
  return result;
}
Result refused(const std::string& reason) {
  Result result;
  result.successful = false;
  result.reason = reason;
  return result;
}

constexpr const char* wrong_type = "Wrong parameter type, ";

/// The value is in the range, and a step or the end of it.
bool is_in(std::int64_t value, const rcl_interfaces::msg::IntegerRange& range) {
  if (value < range.from_value || value > range.to_value) return false;
  if (range.step == 0 || value == range.to_value) return true;
  return (static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(range.from_value)) % range.step == 0;
}
bool is_in(double value, const rcl_interfaces::msg::FloatingPointRange& range) {
  const auto is_near = [](double one, double other) {
    constexpr double units = 100.0;
    return std::abs(one - other) <= std::abs(one + other) * std::numeric_limits<double>::epsilon() * units;
  };
  if (is_near(value, range.from_value) || is_near(value, range.to_value)) return true;
  if (!(value >= range.from_value && value <= range.to_value)) return false;
  if (range.step == 0.0) return true;
  return is_near(value, range.from_value + std::round((value - range.from_value) / range.step) * range.step);
}

Result judge_value(const Descriptor& descriptor, const Parameter& parameter, bool is_declaration) {
  const std::string& name = parameter.get_name();
  if (descriptor.read_only && !is_declaration)
    return refused("parameter '" + name + "' cannot be set because it is read-only");
  const ParameterType type = parameter.get_type();
  if (!descriptor.dynamic_typing && type != descriptor.type)
    return refused(wrong_type + ("parameter {" + name) + "} is of type {" +
                   to_string(static_cast<ParameterType>(descriptor.type)) + "}, setting it to {" + to_string(type) +
                   "} is not allowed.");
  if (type == rclcpp::PARAMETER_INTEGER && !descriptor.integer_range.empty() &&
      !is_in(parameter.as_int(), descriptor.integer_range[0]))
    return refused("Parameter {" + name + "} doesn't comply with integer range.");
  if (type == rclcpp::PARAMETER_DOUBLE && !descriptor.floating_point_range.empty() &&
      !is_in(parameter.as_double(), descriptor.floating_point_range[0]))
    return refused("Parameter {" + name + "} doesn't comply with floating point range.");
  return accepted();
}

/// The handles of callbacks that nobody has dropped.
template <class Handle>
std::vector<std::shared_ptr<Handle>> present(const std::list<std::weak_ptr<Handle>>& handles) {
  std::vector<std::shared_ptr<Handle>> found;
  for (const auto& handle : handles)
    if (auto is_there = handle.lock()) found.push_back(std::move(is_there));
  return found;
}

/// The callback that was added last is called first.
template <class Handle, class Callback>
std::shared_ptr<Handle> add(std::list<std::weak_ptr<Handle>>& handles, Callback callback) {
  auto handle = std::make_shared<Handle>();
  handle->callback = std::move(callback);
  handles.push_front(handle);
  return handle;
}

template <class Handle>
void remove(std::list<std::weak_ptr<Handle>>& handles, const Handle* handle) {
  const auto place =
      std::find_if(handles.begin(), handles.end(), [&](const auto& known) { return known.lock().get() == handle; });
  if (place == handles.end()) throw std::runtime_error("Callback doesn't exist");
  handles.erase(place);
}

exceptions::ParameterNotDeclaredException not_declared(const std::string& name, const std::string& deed) {
  return exceptions::ParameterNotDeclaredException("parameter '" + name + "' cannot be " + deed +
                                                   " because it was not declared");
}

}  // namespace

/// A change is under way during its lifetime; callbacks may not begin another one.
class NodeParameters::Changing {
 public:
  explicit Changing(bool& is_changing) : is_changing_(is_changing) {
    if (is_changing_)
      throw exceptions::ParameterModifiedInCallbackException(
          "cannot set or declare a parameter, or change the callback from within set callback");
    is_changing_ = true;
  }
  ~Changing() { is_changing_ = false; }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;

 private:
  bool& is_changing_;
};

NodeParameters::NodeParameters(Overrides overrides, const rclcpp::NodeOptions& options)
    : overrides_(std::move(overrides)), allow_undeclared_(options.allow_undeclared_parameters()) {
  for (const Parameter& parameter : options.parameter_overrides())
    overrides_[parameter.get_name()] = parameter.get_parameter_value();
  if (options.automatically_declare_parameters_from_overrides()) {
    Descriptor any;
    any.dynamic_typing = true;
    for (const auto& [name, value] : overrides_) declare(name, value.get_type(), value, any, true);
  }
  if (!has_parameter("use_sim_time"))
    declare("use_sim_time", rclcpp::PARAMETER_BOOL, ParameterValue(false), Descriptor(), false);
}

const NodeParameters::Declared* NodeParameters::find(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? nullptr : &found->second;
}

Result NodeParameters::judge(const std::vector<Parameter>& parameters, bool is_declaration) const {
  for (const Parameter& parameter : parameters) {
    Result result = judge_value(parameters_.at(parameter.get_name()).descriptor, parameter, is_declaration);
    if (!result.successful) return result;
  }
  for (const auto& handle : present(on_)) {
    Result result = handle->callback(parameters);
    if (!result.successful) return result;
  }
  return accepted();
}

void NodeParameters::tell_post(const std::vector<Parameter>& parameters) const {
  for (const auto& handle : present(post_)) handle->callback(parameters);
}

const ParameterValue& NodeParameters::declare(const std::string& name, ParameterType type, const ParameterValue& value,
                                              const Descriptor& descriptor, bool ignore_override) {
  const std::lock_guard lock(mutex_);
  {
    const Changing changing(is_changing_);
    if (name.empty()) throw exceptions::InvalidParametersException("parameter name must not be empty");
    if (find(name) != nullptr)
      throw exceptions::ParameterAlreadyDeclaredException("parameter '" + name + "' has already been declared");
    if (!descriptor.dynamic_typing && type == rclcpp::PARAMETER_NOT_SET)
      throw exceptions::InvalidParameterTypeException(
          name, "cannot declare a statically typed parameter with an uninitialized value");
    Declared declared{value, descriptor};
    declared.descriptor.name = name;
    declared.descriptor.type = descriptor.dynamic_typing ? rclcpp::PARAMETER_NOT_SET : type;
    const auto override_of = overrides_.find(name);
    if (!ignore_override && override_of != overrides_.end() &&
        override_of->second.get_type() != rclcpp::PARAMETER_NOT_SET)
      declared.value = override_of->second;
    Declared& place = parameters_[name] = declared;
    if (place.value.get_type() == rclcpp::PARAMETER_NOT_SET) return place.value;
    const Result result = judge({Parameter(name, place.value)}, true);
    if (!result.successful) {
      parameters_.erase(name);
      if (result.reason.rfind(wrong_type, 0) == 0) throw exceptions::InvalidParameterTypeException(name, result.reason);
      throw exceptions::InvalidParameterValueException("parameter '" + name + "' could not be set: " + result.reason);
    }
  }
  const ParameterValue& declared = parameters_.at(name).value;
  tell_post({Parameter(name, declared)});
  if (on_change) on_change({Parameter(name, declared)}, {});
  return declared;
}

const ParameterValue& NodeParameters::declare_parameter(const std::string& name, const ParameterValue& value,
                                                        const Descriptor& descriptor, bool ignore_override) {
  return declare(name, value.get_type(), value, descriptor, ignore_override);
}

const ParameterValue& NodeParameters::declare_parameter(const std::string& name, ParameterType type,
                                                        const Descriptor& descriptor, bool ignore_override) {
  if (type == rclcpp::PARAMETER_NOT_SET)
    throw std::invalid_argument("a parameter can't be declared with the type rclcpp::PARAMETER_NOT_SET");
  if (descriptor.dynamic_typing)
    throw std::invalid_argument("a parameter of a stated type can't have a descriptor with dynamic_typing");
  return declare(name, type, ParameterValue(), descriptor, ignore_override);
}

void NodeParameters::undeclare_parameter(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const Changing changing(is_changing_);
  const Declared* declared = find(name);
  if (declared == nullptr) throw not_declared(name, "undeclared");
  if (declared->descriptor.read_only)
    throw exceptions::ParameterImmutableException("cannot undeclare parameter '" + name + "' because it is read-only");
  if (!declared->descriptor.dynamic_typing)
    throw exceptions::InvalidParameterTypeException(name, "cannot undeclare a statically typed parameter");
  parameters_.erase(name);
}

std::vector<Result> NodeParameters::set_parameters(const std::vector<Parameter>& parameters) {
  std::vector<Result> results;
  for (const Parameter& parameter : parameters) results.push_back(set_parameters_atomically({parameter}));
  return results;
}

Result NodeParameters::set_parameters_atomically(const std::vector<Parameter>& given) {
  const std::lock_guard lock(mutex_);
  std::vector<Parameter> parameters = given, declared, changed;
  {
    const Changing changing(is_changing_);
    for (const auto& handle : present(pre_)) handle->callback(parameters);
    if (parameters.empty() && !given.empty()) return refused("parameters are empty after the callbacks before the set");
    for (const Parameter& parameter : parameters) {
      if (find(parameter.get_name()) != nullptr) {
        changed.push_back(parameter);
        continue;
      }
      if (!allow_undeclared_) throw not_declared(parameter.get_name(), "set");
      declared.push_back(parameter);
    }
    for (const Parameter& parameter : declared) {
      Declared& place = parameters_[parameter.get_name()];
      place.descriptor.name = parameter.get_name();
      place.descriptor.dynamic_typing = true;
    }
    Result result = judge(parameters, false);
    if (!result.successful) {
      for (const Parameter& parameter : declared) parameters_.erase(parameter.get_name());
      return result;
    }
    for (const Parameter& parameter : parameters)
      parameters_.at(parameter.get_name()).value = parameter.get_parameter_value();
  }
  tell_post(parameters);
  if (on_change) on_change(declared, changed);
  return accepted();
}

std::vector<Parameter> NodeParameters::get_parameters(const std::vector<std::string>& names) const {
  std::vector<Parameter> parameters;
  for (const std::string& name : names) parameters.push_back(get_parameter(name));
  return parameters;
}

Parameter NodeParameters::get_parameter(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const Declared* declared = find(name);
  if (declared == nullptr) {
    if (allow_undeclared_) return Parameter(name);
    throw exceptions::ParameterNotDeclaredException(name);
  }
  if (declared->value.get_type() == rclcpp::PARAMETER_NOT_SET && !declared->descriptor.dynamic_typing)
    throw exceptions::ParameterUninitializedException("parameter '" + name + "' is not initialized");
  return Parameter(name, declared->value);
}

bool NodeParameters::get_parameter(const std::string& name, Parameter& parameter) const {
  const std::lock_guard lock(mutex_);
  const Declared* declared = find(name);
  if (declared == nullptr || declared->value.get_type() == rclcpp::PARAMETER_NOT_SET) return false;
  parameter = Parameter(name, declared->value);
  return true;
}

bool NodeParameters::get_parameters_by_prefix(const std::string& prefix,
                                              std::map<std::string, Parameter>& parameters) const {
  const std::lock_guard lock(mutex_);
  const std::string begin = prefix.empty() ? "" : prefix + ".";
  bool is_found = false;
  for (const auto& [name, declared] : parameters_) {
    if (name.size() <= begin.size() || name.compare(0, begin.size(), begin) != 0) continue;
    parameters[name.substr(begin.size())] = Parameter(name, declared.value);
    is_found = true;
  }
  return is_found;
}

std::vector<Descriptor> NodeParameters::describe_parameters(const std::vector<std::string>& names) const {
  const std::lock_guard lock(mutex_);
  std::vector<Descriptor> descriptors;
  for (const std::string& name : names) {
    const Declared* declared = find(name);
    if (declared == nullptr && !allow_undeclared_) throw exceptions::ParameterNotDeclaredException(name);
    Descriptor descriptor;
    descriptor.name = name;
    if (declared != nullptr) {
      descriptor = declared->descriptor;
      if (descriptor.dynamic_typing) descriptor.type = declared->value.get_type();
    }
    descriptors.push_back(descriptor);
  }
  return descriptors;
}

std::vector<std::uint8_t> NodeParameters::get_parameter_types(const std::vector<std::string>& names) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint8_t> types;
  for (const std::string& name : names) {
    const Declared* declared = find(name);
    if (declared == nullptr && !allow_undeclared_) throw exceptions::ParameterNotDeclaredException(name);
    types.push_back(declared == nullptr ? rclcpp::PARAMETER_NOT_SET : declared->value.get_type());
  }
  return types;
}

rcl_interfaces::msg::ListParametersResult NodeParameters::list_parameters(const std::vector<std::string>& prefixes,
                                                                          std::uint64_t depth) const {
  const std::lock_guard lock(mutex_);
  rcl_interfaces::msg::ListParametersResult result;
  const auto is_within = [depth](const std::string& name) {
    return depth == 0 || static_cast<std::uint64_t>(std::count(name.begin(), name.end(), '.')) < depth;
  };
  for (const auto& [name, declared] : parameters_) {
    bool is_listed = prefixes.empty() && is_within(name);
    for (const std::string& prefix : prefixes)
      is_listed |= name == prefix || (name.rfind(prefix + ".", 0) == 0 && is_within(name.substr(prefix.size() + 1)));
    if (!is_listed) continue;
    result.names.push_back(name);
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) continue;
    const std::string prefix = name.substr(0, dot);
    if (std::find(result.prefixes.begin(), result.prefixes.end(), prefix) == result.prefixes.end())
      result.prefixes.push_back(prefix);
  }
  return result;
}

rclcpp::node_interfaces::PreSetParametersCallbackHandle::SharedPtr NodeParameters::add_pre_set_parameters_callback(
    PreSetParametersCallbackType callback) {
  const std::lock_guard lock(mutex_);
  return add(pre_, std::move(callback));
}
rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr NodeParameters::add_on_set_parameters_callback(
    OnSetParametersCallbackType callback) {
  const std::lock_guard lock(mutex_);
  return add(on_, std::move(callback));
}
rclcpp::node_interfaces::PostSetParametersCallbackHandle::SharedPtr NodeParameters::add_post_set_parameters_callback(
    PostSetParametersCallbackType callback) {
  const std::lock_guard lock(mutex_);
  return add(post_, std::move(callback));
}
void NodeParameters::remove_pre_set_parameters_callback(
    const rclcpp::node_interfaces::PreSetParametersCallbackHandle* handle) {
  const std::lock_guard lock(mutex_);
  remove(pre_, handle);
}
void NodeParameters::remove_on_set_parameters_callback(
    const rclcpp::node_interfaces::OnSetParametersCallbackHandle* handle) {
  const std::lock_guard lock(mutex_);
  remove(on_, handle);
}
void NodeParameters::remove_post_set_parameters_callback(
    const rclcpp::node_interfaces::PostSetParametersCallbackHandle* handle) {
  const std::lock_guard lock(mutex_);
  remove(post_, handle);
}

}  // namespace rehearse_ros2
