#include "variable_history.h"

#include <fmt/format.h>

#include <vector>

#include "core/kinds/channel_name.h"

namespace rehearse {

void VariableHistory::add(const std::string& topic, std::int64_t tick, double recorded, double present) {
  is_whole_ = is_whole_ && (tick == last_tick_ || count_ < most);  // ticks are kept whole
  if (!is_whole_) return;
  last_tick_ = tick;
  ++count_;
  PairedSeries& series = series_[topic];
  series.ticks.push_back(tick);
  series.recorded.push_back(recorded);
  series.present.push_back(present);
}

std::string VariableHistory::explanation(int controllers) const {
  std::vector<PairedSeries> all;
  for (const auto& [topic, series] : series_) {
    const ChannelName name = ChannelName::parse(topic);
    all.push_back(series);
    all.back().name = controllers > 1 ? topic.substr(1) : std::string(topic_segment(name.owner));
  }
  return to_string(find_relations(all), all, is_whole_);
}

}  // namespace rehearse
