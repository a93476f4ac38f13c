#include <fmt/format.h>

#include <utility>

#include "other_schemas.h"
#include "ros2msg_literal.h"

namespace rehearse::ros2msg {
namespace {

/// Types that ROS 2 names otherwise.
constexpr std::pair<std::string_view, std::string_view> renamed[] = {{"time", "builtin_interfaces/Time"},
                                                                     {"duration", "builtin_interfaces/Duration"},
                                                                     {"Header", "std_msgs/Header"},
                                                                     {"byte", "int8"}};

/// A line as ROS 2 writes it; empty for a constant. Whatever stands behind '=' in a text constant belongs to it.
std::string converted(std::string_view line) {
  if (line.starts_with("MSG:") || line.find_first_not_of('=') == std::string_view::npos) return std::string(line);
  line = trim(line.substr(0, line.find('#')));
  if (line.find('=') != std::string_view::npos) return {};
  const std::string_view type = line.substr(0, line.find_first_of(" \t["));
  for (const auto& [before, after] : renamed)
    if (type == before) return fmt::format("{}{}", after, line.substr(type.size()));
  return std::string(line);
}

}  // namespace

Result<Schema> parse_ros1(std::string_view type, std::string_view text, std::string file) {
  std::string lines;  // as many as in the text, for errors
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines += converted(trim(text.substr(0, end))) + '\n';
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return Schema::parse(type, lines, std::move(file));
}

}  // namespace rehearse::ros2msg
