#include "rclcpp/logger.hpp"

#include <rcutils/logging.h>

namespace rclcpp {

void Logger::set_level(Level level) { (void)rcutils_logging_set_logger_level(name_.c_str(), static_cast<int>(level)); }
Logger::Level Logger::get_effective_level() const {
  return static_cast<Level>(rcutils_logging_get_logger_effective_level(name_.c_str()));
}

}  // namespace rclcpp
