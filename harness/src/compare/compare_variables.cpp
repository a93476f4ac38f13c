// Controllers' variables that nobody asked to compare: what they do is remarked, and decides nothing.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "asked_variables.h"
#include "compare_parts.h"
#include "trace/float64_message.h"

namespace rehearse {
namespace {

bool is_variable(const TraceChannel& channel) {
  return channel.type == msg::Float64::type_name && ChannelName::parse(channel.topic).kind == ChannelKind::variable;
}

/// The time of the first message that isn't the same in both [ns]; none: they are the same.
std::optional<std::uint64_t> first_difference(const TraceChannel& a, const TraceChannel& b, std::uint64_t end) {
  const std::size_t both = std::min(a.rows(), b.rows());
  for (std::size_t row = 0; row < both; ++row) {
    const std::uint64_t time = std::min(a.times[row], b.times[row]);
    if (time > end) return std::nullopt;
    if (a.times[row] != b.times[row] || a.bits(row, 0) != b.bits(row, 0)) return time;
  }
  if (a.rows() == b.rows()) return std::nullopt;
  const std::uint64_t time = (a.rows() > b.rows() ? a : b).times[both];
  return time > end ? std::nullopt : std::optional(time);
}

}  // namespace

bool isnt_compared(const TraceChannel& channel, const std::vector<ToleranceRule>& rules) {
  if (ChannelName::parse(channel.topic).side == ChannelSide::acted) return true;
  return is_variable(channel) && !asks_for_variable(series_of(channel), rules);
}

std::string remark_on_variables(const ComparedTraces& traces) {
  struct Found {
    std::uint64_t time;
    std::string text;
  };
  std::vector<Found> found;
  const auto look_at = [&](const Trace& of, const Trace& other, const char* which) {
    for (const TraceChannel& channel : of.channels()) {
      if (!is_variable(channel) || asks_for_variable(series_of(channel), traces.rules) || channel.times.empty())
        continue;
      const std::string series(series_of(channel));
      const TraceChannel* there = other.find_channel(channel.topic);
      if (!there && channel.times[0] <= traces.end)
        found.push_back({channel.times[0], fmt::format("{} is in the {} only", series, which)});
      if (!there || !is_variable(*there) || &of != &traces.golden) continue;
      if (const auto time = first_difference(channel, *there, traces.end))
        found.push_back({*time, fmt::format("{} differs at tick {}", series, traces.clock.tick_at(*time))});
    }
  };
  look_at(traces.golden, traces.actual, "golden");
  look_at(traces.actual, traces.golden, "run");
  if (found.empty()) return {};
  const auto first =
      std::min_element(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.time < b.time; });
  const std::size_t others = found.size() - 1;
  return fmt::format("controllers' variables, which no rule asks to compare: {}{}", first->text,
                     others == 0   ? ""
                     : others == 1 ? ", and one more isn't the same"
                                   : fmt::format(", and {} more aren't the same", others));
}

}  // namespace rehearse
