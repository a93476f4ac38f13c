// Names of links and devices as segments of a topic. A URDF's names may hold slashes, and slashes are what segments are
// told apart by: '/' is written %2F, and '%' is written %25. All other names are as they are.
#pragma once

#include <string>
#include <string_view>

namespace rehearse {

inline std::string topic_segment(std::string_view name) {
  std::string segment;
  for (const char c : name) {
    if (c == '/' || c == '%')
      segment += c == '/' ? "%2F" : "%25";
    else
      segment += c;
  }
  return segment;
}

/// The name that topic_segment() wrote so.
inline std::string name_of_segment(std::string_view segment) {
  std::string name;
  while (!segment.empty()) {
    const bool is_slash = segment.starts_with("%2F"), is_percent = segment.starts_with("%25");
    name += is_slash ? '/' : segment.front();
    segment.remove_prefix(is_slash || is_percent ? 3 : 1);
  }
  return name;
}

}  // namespace rehearse
