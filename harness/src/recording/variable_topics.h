// The topics of controllers' variables: /<body>/<controller>/variable/<name>.
#pragma once

#include <string>
#include <string_view>

#include "topic_segment.h"

namespace rehearse {

inline std::string variable_topic(std::string_view controller_label, std::string_view name) {
  return "/" + std::string(controller_label) + "/variable/" + topic_segment(name);
}

/// What comes after "/variable/" in such a topic, as it stands there; empty: it is none.
inline std::string_view variable_of_topic(std::string_view topic) {
  constexpr std::string_view part = "/variable/";
  const std::size_t last = topic.rfind('/');
  if (last == std::string_view::npos || last == 0) return {};
  const std::size_t at = topic.rfind('/', last - 1);  // /<body>/<controller> come before
  if (at == std::string_view::npos || topic.substr(at, last + 1 - at) != part) return {};
  const std::string_view owner = topic.substr(0, at);
  const bool of_a_controller = owner.size() > 1 && owner.find('/', 1) != std::string_view::npos;
  return of_a_controller ? topic.substr(last + 1) : std::string_view();
}

}  // namespace rehearse
