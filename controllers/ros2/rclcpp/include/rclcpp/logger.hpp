// Loggers: lines with a level and a name, on the logging of rcutils.
#pragma once

// ros2_control uses these two without including them.
#include <cxxabi.h>
#include <numeric>

#include <rcutils/logging_macros.h>

#include <sstream>
#include <string>
#include <utility>

namespace rclcpp {

class Logger {
 public:
  enum class Level {
    Unset = RCUTILS_LOG_SEVERITY_UNSET,
    Debug = RCUTILS_LOG_SEVERITY_DEBUG,
    Info = RCUTILS_LOG_SEVERITY_INFO,
    Warn = RCUTILS_LOG_SEVERITY_WARN,
    Error = RCUTILS_LOG_SEVERITY_ERROR,
    Fatal = RCUTILS_LOG_SEVERITY_FATAL
  };
  Logger() = default;
  explicit Logger(std::string name) : name_(std::move(name)) {}
  const char* get_name() const { return name_.c_str(); }
  Logger get_child(const std::string& suffix) const { return Logger(name_.empty() ? suffix : name_ + "." + suffix); }
  void set_level(Level level);
  Level get_effective_level() const;

 private:
  std::string name_;
};

inline Logger get_logger(const std::string& name) { return Logger(name); }
/// The folder of log files; empty: lines go to the streams of the process.
inline std::string get_logging_directory() { return {}; }

}  // namespace rclcpp
