// Controllers' variables that no rule compares: their differences are a remark, and fail nothing.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/glob.h"
#include "compare_variables.h"
#include "core/kinds/channel_name.h"
#include "series_rules.h"

namespace rehearse {
namespace {

bool is_variable(const TraceChannel& channel) {
  return channel.type == msg::Float64::type_name && ChannelName::parse(channel.topic).kind == ChannelKind::variable;
}

/// The time of the first message of a window that differs [ns]; none: all are equal.
std::optional<std::uint64_t> first_difference(const Window& window, const TraceChannel& a, const TraceChannel& b) {
  auto [row, end] = window.messages(a);
  auto [other, other_end] = window.messages(b);
  for (; row < end && other < other_end; ++row, ++other)
    if (a.times[row] != b.times[other] || a.bits(row, 0) != b.bits(other, 0))
      return std::min(a.times[row], b.times[other]);
  if (row < end) return a.times[row];
  return other < other_end ? std::optional(b.times[other]) : std::nullopt;
}

}  // namespace

bool asks_for_variable(std::string_view series, const std::vector<ToleranceRule>& rules) {
  return std::ranges::any_of(rules, [&](const ToleranceRule& rule) {
    return rule.channel.find(run_topics::variable_part) != std::string::npos && matches(rule.channel, series);
  });
}

bool isnt_compared(const TraceChannel& channel, const std::vector<ToleranceRule>& rules) {
  if (ChannelName::parse(channel.topic).side == ChannelSide::acted) return true;
  return is_variable(channel) && !asks_for_variable(series_of(channel), rules);
}

VariablesRemark::VariablesRemark(const ComparedTraces& traces) : traces_(traces) {
  if (!traces.options.takes(Stage::controller)) return;
  find_lone(traces.golden, traces.golden_run, traces.actual, "golden");
  find_lone(traces.actual, traces.actual_run, traces.golden, "run");
}

void VariablesRemark::find_lone(const Trace& of, const RunSurvey& run, const Trace& other, const char* which) {
  for (const TraceChannel& channel : of.channels()) {
    const ChannelSurvey& survey = run.of(channel);
    if (!is_variable(channel) || asks_for_variable(series_of(channel), traces_.rules) || survey.messages == 0) continue;
    const TraceChannel* there = other.find_channel(channel.topic);
    const std::size_t order = found_.size() + channels_.size();
    if (!there && survey.first_time <= traces_.end)
      found_.push_back({survey.first_time, order, fmt::format("{} is in the {} only", series_of(channel), which)});
    if (!there || !is_variable(*there) || &of != &traces_.golden) continue;
    const PairedChannel pair{channel, *there, survey, traces_.actual_run.of(*there)};
    if (pair.is_equal()) continue;
    channels_.push_back(pair);
    orders_.push_back(order);
  }
}

void VariablesRemark::take(const Window& window) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!orders_[i]) continue;
    const TraceChannel& golden = table_in(window.golden, traces_.golden, channels_[i].golden);
    const auto time = first_difference(window, golden, table_in(window.actual, traces_.actual, channels_[i].actual));
    if (!time) continue;
    found_.push_back({*time, *std::exchange(orders_[i], std::nullopt),
                      fmt::format("{} differs at tick {}", series_of(golden), traces_.clock.tick_at(*time))});
  }
}

std::string VariablesRemark::text() const {
  if (found_.empty()) return {};
  const auto first = std::ranges::min_element(
      found_, [](const Found& a, const Found& b) { return std::pair(a.time, a.order) < std::pair(b.time, b.order); });
  const std::size_t others = found_.size() - 1;
  return fmt::format("controllers' variables, which no rule compares: {}{}", first->text,
                     others == 0   ? ""
                     : others == 1 ? ", and one more differs"
                                   : fmt::format(", and {} more differ", others));
}

}  // namespace rehearse
