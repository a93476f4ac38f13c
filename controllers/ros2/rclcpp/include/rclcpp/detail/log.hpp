// What the log macros of all levels are made of. They expand in the code of users, under its warnings.
#pragma once

#include <cstdint>
#include <limits>
#include <sstream>

#include "rclcpp/logger.hpp"

namespace rclcpp::detail {

/// Takes loggers only.
inline const char* name_for_log(const Logger& logger) { return logger.get_name(); }

/// True if the time since the last true is at least `duration`; both in nanoseconds.
inline bool is_over(std::int64_t& last, std::int64_t now, std::int64_t duration) {
  if (last != std::numeric_limits<std::int64_t>::min() && now >= last && now - last < duration) return false;
  last = now;
  return true;
}

}  // namespace rclcpp::detail

#define REHEARSE_LOG(level, logger, ...)                                              \
  do {                                                                                \
    RCUTILS_LOG_##level##_NAMED(::rclcpp::detail::name_for_log(logger), __VA_ARGS__); \
  } while (0)
#define REHEARSE_STREAMED(...)        \
  [&]() {                             \
    std::ostringstream rehearse_text; \
    rehearse_text << __VA_ARGS__;     \
    return rehearse_text.str();       \
  }()                                 \
      .c_str()
#define REHEARSE_LOG_ONCE(...)            \
  do {                                    \
    static bool rehearse_is_said = false; \
    if (!rehearse_is_said) {              \
      rehearse_is_said = true;            \
      __VA_ARGS__;                        \
    }                                     \
  } while (0)
#define REHEARSE_LOG_SKIPFIRST(...)       \
  do {                                    \
    static bool rehearse_is_first = true; \
    if (rehearse_is_first) {              \
      rehearse_is_first = false;          \
    } else {                              \
      __VA_ARGS__;                        \
    }                                     \
  } while (0)
#define REHEARSE_LOG_IF(condition, ...) \
  do {                                  \
    if (condition) {                    \
      __VA_ARGS__;                      \
    }                                   \
  } while (0)
#define REHEARSE_LOG_THROTTLE(clock, milliseconds, ...)                                 \
  do {                                                                                  \
    static std::int64_t rehearse_last = std::numeric_limits<std::int64_t>::min();       \
    if (::rclcpp::detail::is_over(rehearse_last, (clock).now().nanoseconds(),           \
                                  static_cast<std::int64_t>(milliseconds) * 1000000)) { \
      __VA_ARGS__;                                                                      \
    }                                                                                   \
  } while (0)
