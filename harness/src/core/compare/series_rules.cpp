#include "series_rules.h"

#include <rehearse/messages.h>

#include <algorithm>

namespace rehearse {

std::size_t column_of(const TraceChannel& channel, std::string_view element) {
  const auto found =
      std::ranges::find_if(channel.columns, [&](const TraceColumn& column) { return column.element == element; });
  return static_cast<std::size_t>(found - channel.columns.begin());
}

const std::string& series_of(const TraceChannel& channel, const TraceColumn& column) {
  return channel.type == msg::TFMessage::type_name ? column.element : column.series;
}

std::string_view series_of(const TraceChannel& channel) {
  const std::string_view topic = channel.topic;
  return topic.starts_with('/') ? topic.substr(1) : topic;
}

}  // namespace rehearse
