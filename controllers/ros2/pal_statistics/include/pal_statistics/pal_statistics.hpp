// Statistics that packages register by name and pointer. They are accepted, and not published.
#pragma once

#include <functional>
#include <rclcpp/rclcpp.hpp>
#include <string>

namespace pal_statistics {

using IdType = unsigned int;

class RegistrationsRAII {
 public:
  bool enableAll() { return true; }
  bool disableAll() { return true; }
  void clear() {}
};

class StatisticsRegistry {
 public:
  template <class... Arguments>
  IdType registerVariable(const Arguments&...) {
    return 0;
  }
  template <class... Arguments>
  IdType registerFunction(const Arguments&...) {
    return 0;
  }
};

template <class Value>
IdType customRegister(StatisticsRegistry&, const std::string&, const Value*, RegistrationsRAII* = nullptr,
                      bool = true) {
  return 0;
}

namespace detail {
template <class... Arguments>
void ignore(const Arguments&...) {}
}  // namespace detail

}  // namespace pal_statistics
