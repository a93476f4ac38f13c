// Options of a node.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/parameter.hpp"
#include "rclcpp/publisher.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

class NodeOptions {
 public:
  NodeOptions() = default;

#define REHEARSE_OPTION(Type, name, initial)   \
 public:                                       \
  const Type& name() const { return name##_; } \
  NodeOptions& name(const Type& value) {       \
    name##_ = value;                           \
    return *this;                              \
  }                                            \
                                               \
 private:                                      \
  Type name##_ = initial;
  REHEARSE_OPTION(Context::SharedPtr, context, get_global_default_context())
  REHEARSE_OPTION(std::vector<std::string>, arguments, {})
  REHEARSE_OPTION(bool, use_global_arguments, true)
  REHEARSE_OPTION(bool, enable_rosout, true)
  REHEARSE_OPTION(bool, use_intra_process_comms, false)
  REHEARSE_OPTION(bool, enable_topic_statistics, false)
  REHEARSE_OPTION(bool, start_parameter_services, true)
  REHEARSE_OPTION(bool, enable_logger_service, false)
  REHEARSE_OPTION(bool, start_parameter_event_publisher, true)
  REHEARSE_OPTION(bool, use_clock_thread, true)
  REHEARSE_OPTION(bool, allow_undeclared_parameters, false)
  REHEARSE_OPTION(bool, automatically_declare_parameters_from_overrides, false)
  REHEARSE_OPTION(QoS, clock_qos, ClockQoS())
  REHEARSE_OPTION(QoS, rosout_qos, RosoutQoS())
  REHEARSE_OPTION(QoS, parameter_event_qos, ParameterEventsQoS())
  REHEARSE_OPTION(rcl_clock_type_t, clock_type, RCL_ROS_TIME)
  REHEARSE_OPTION(std::vector<Parameter>, parameter_overrides, {})
#undef REHEARSE_OPTION

 public:
  std::vector<Parameter>& parameter_overrides() { return parameter_overrides_; }
  template <class Value>
  NodeOptions& append_parameter_override(const std::string& name, const Value& value) {
    parameter_overrides_.emplace_back(name, ParameterValue(value));
    return *this;
  }
};

}  // namespace rclcpp
