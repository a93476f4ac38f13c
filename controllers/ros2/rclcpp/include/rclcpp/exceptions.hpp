// The exceptions of rclcpp.
#pragma once

#include <stdexcept>
#include <string>

#include "rcl/types.h"

namespace rclcpp::exceptions {

class RCLErrorBase {
 public:
  explicit RCLErrorBase(std::string text) : message(text), formatted_message(std::move(text)) {}
  virtual ~RCLErrorBase() = default;
  rcl_ret_t ret = RCL_RET_ERROR;
  std::string message;
  std::string file;
  std::size_t line = 0;
  std::string formatted_message;
};

#define REHEARSE_RCL_ERROR(Name, Standard)                                              \
  class Name : public RCLErrorBase, public std::Standard {                              \
   public:                                                                              \
    explicit Name(const std::string& text) : RCLErrorBase(text), std::Standard(text) {} \
  };
REHEARSE_RCL_ERROR(RCLError, runtime_error)
REHEARSE_RCL_ERROR(RCLInvalidArgument, invalid_argument)
REHEARSE_RCL_ERROR(RCLInvalidROSArgsError, runtime_error)
#undef REHEARSE_RCL_ERROR

#define REHEARSE_EXCEPTION(Name, Standard)                                  \
  class Name : public std::Standard {                                       \
   public:                                                                  \
    explicit Name(const std::string& text = #Name) : std::Standard(text) {} \
  };
REHEARSE_EXCEPTION(InvalidEventError, runtime_error)
REHEARSE_EXCEPTION(EventNotRegisteredError, runtime_error)
REHEARSE_EXCEPTION(InvalidNodeError, runtime_error)
REHEARSE_EXCEPTION(NameValidationError, invalid_argument)
REHEARSE_EXCEPTION(InvalidNodeNameError, invalid_argument)
REHEARSE_EXCEPTION(InvalidNamespaceError, invalid_argument)
REHEARSE_EXCEPTION(InvalidTopicNameError, invalid_argument)
REHEARSE_EXCEPTION(InvalidServiceNameError, invalid_argument)
REHEARSE_EXCEPTION(InvalidServiceTypeError, runtime_error)
REHEARSE_EXCEPTION(UnimplementedError, runtime_error)
REHEARSE_EXCEPTION(UnknownROSArgsError, runtime_error)
REHEARSE_EXCEPTION(UnsupportedEventTypeException, runtime_error)
REHEARSE_EXCEPTION(InvalidParametersException, runtime_error)
REHEARSE_EXCEPTION(InvalidParameterValueException, runtime_error)
REHEARSE_EXCEPTION(ParameterAlreadyDeclaredException, runtime_error)
REHEARSE_EXCEPTION(ParameterNotDeclaredException, runtime_error)
REHEARSE_EXCEPTION(ParameterImmutableException, runtime_error)
REHEARSE_EXCEPTION(ParameterModifiedInCallbackException, runtime_error)
REHEARSE_EXCEPTION(ParameterUninitializedException, runtime_error)
REHEARSE_EXCEPTION(QoSCheckCompatibleException, runtime_error)
#undef REHEARSE_EXCEPTION

class InvalidParameterTypeException : public std::runtime_error {
 public:
  InvalidParameterTypeException(const std::string& name, const std::string& text)
      : std::runtime_error("parameter '" + name + "' has invalid type: " + text) {}
};

}  // namespace rclcpp::exceptions
