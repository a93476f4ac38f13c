#include "state_rate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "core/kinds/channel_name.h"
#include "run_facts.h"

namespace rehearse {
namespace {

constexpr const char *rate_key = "rate", *time_step_key = "time_step", *whole_prefix = "whole.";

double number_or_zero(const mcap::StringMap& metadata, const char* key) {
  return number_in<double>(stated(metadata, key)).value_or(0.0);
}

}  // namespace

bool is_state(std::string_view topic) {
  const ChannelName name = ChannelName::parse(topic);
  return name.side == ChannelSide::none && name.kind != ChannelKind::other && form_of(name.kind).is_state;
}

bool StateRate::reduces(std::string_view topic) const { return !whole.contains(std::string(topic)) && is_state(topic); }

std::int64_t StateRate::period() const {
  return std::max(std::int64_t{1}, std::int64_t{std::llround(1.0 / (rate * time_step))});
}

bool StateRate::is_sample(std::uint64_t time) const {
  return std::llround(static_cast<double>(time) * 1e-9 / time_step) % period() == 0;
}

bool StateRate::includes(const StateRate& other) const {
  return rate == other.rate && time_step == other.time_step && std::ranges::includes(whole, other.whole);
}

mcap::StringMap StateRate::metadata() const {
  mcap::StringMap metadata{{rate_key, fmt::format("{}", rate)}, {time_step_key, fmt::format("{}", time_step)}};
  for (const std::string& topic : whole) metadata[whole_prefix + topic] = "every tick";
  return metadata;
}

StateRate StateRate::of(const mcap::StringMap& metadata) {
  StateRate state{number_or_zero(metadata, rate_key), number_or_zero(metadata, time_step_key), {}};
  const std::string_view prefix = whole_prefix;
  for (const auto& [key, value] : metadata)
    if (key.starts_with(prefix)) state.whole.insert(key.substr(prefix.size()));
  return state;
}

}  // namespace rehearse
