#include "series_scale.h"

#include "base/glob.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

namespace rehearse {

double scale_of(const TraceChannel& channel, std::size_t column) {
  const std::string& element = channel.columns[column].element;
  std::vector<std::size_t> parts{column};
  if (element.ends_with("/x") || element.ends_with("/y") || element.ends_with("/z")) {
    const std::string_view stem = std::string_view(element).substr(0, element.size() - 1);
    parts.clear();
    for (std::size_t i = 0; i < channel.columns.size(); ++i) {
      const std::string_view other = channel.columns[i].element;
      if (other.size() == element.size() && other.starts_with(stem) && other.back() != 'w') parts.push_back(i);
    }
  }
  double largest = 0.0;
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    double squares = 0.0;
    for (const std::size_t part : parts) squares += channel.number(row, part) * channel.number(row, part);
    if (std::isfinite(squares)) largest = std::max(largest, squares);
  }
  return std::sqrt(largest);
}

SeriesScales scales_of(const std::filesystem::path& recording, const std::vector<ToleranceRule>& rules) {
  std::vector<ToleranceRule> relative;
  std::ranges::copy_if(rules, std::back_inserter(relative), is_relative);
  SeriesScales scales;
  if (relative.empty()) return scales;
  const auto add = [&](const Trace& piece) {
    for (const TraceChannel& channel : piece.channels()) {
      for (std::size_t i = 0; i < channel.columns.size(); ++i) {
        const TraceColumn& column = channel.columns[i];
        const auto is_meant = [&](const ToleranceRule& rule) { return matches(rule.channel, column.series); };
        if (column.kind != CellKind::floating || std::ranges::none_of(relative, is_meant)) continue;
        double& scale = scales[{channel.topic, column.element}];
        scale = std::max(scale, scale_of(channel, i));
      }
    }
  };
  // The pass that reads the ticks reports damage of the recording.
  static_cast<void>(Trace::load_in_pieces(recording, add));
  return scales;
}

}  // namespace rehearse
