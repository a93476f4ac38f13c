// A message about the state of a part, with functions to fill it.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <sstream>
#include <string>

namespace diagnostic_updater {

class DiagnosticStatusWrapper : public diagnostic_msgs::msg::DiagnosticStatus {
 public:
  void summary(unsigned char of_level, const std::string& text) {
    level = of_level;
    message = text;
  }
  void summary(const diagnostic_msgs::msg::DiagnosticStatus& other) { summary(other.level, other.message); }
  /// The worse level; texts of equally bad ones are joined.
  void mergeSummary(unsigned char of_level, const std::string& text) {
    const bool is_bad = level > OK, is_worse = of_level > OK;
    if (is_bad && is_worse)
      message += "; " + text;
    else if (of_level > level)
      message = text;
    if (of_level > level) level = of_level;
  }
  void mergeSummary(const diagnostic_msgs::msg::DiagnosticStatus& other) { mergeSummary(other.level, other.message); }
  __attribute__((format(printf, 3, 4))) void summaryf(unsigned char of_level, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    summary(of_level, text_of(format, arguments));
    va_end(arguments);
  }
  __attribute__((format(printf, 3, 4))) void mergeSummaryf(unsigned char of_level, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    mergeSummary(of_level, text_of(format, arguments));
    va_end(arguments);
  }
  __attribute__((format(printf, 3, 4))) void addf(const std::string& key, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    add(key, text_of(format, arguments));
    va_end(arguments);
  }
  template <class Value>
  void add(const std::string& key, const Value& value) {
    std::ostringstream text;
    text << std::boolalpha << value;
    diagnostic_msgs::msg::KeyValue entry;
    entry.key = key;
    entry.value = text.str();
    values.push_back(entry);
  }
  void clearSummary() { summary(OK, ""); }
  void clear() { values.clear(); }

 private:
  static std::string text_of(const char* format, va_list arguments) {
    char text[1000];
    std::vsnprintf(text, sizeof text, format, arguments);
    return text;
  }
};

}  // namespace diagnostic_updater
