// EXPECT_REALTIME, without GoogleTest.
#include "realtime_assertions.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <utility>

#include "base/clock.h"
#include "core/guard/cost_counter.h"
#include "core/kinds/channel_name.h"
#include "core/kinds/cost_fields.h"

namespace rehearse::internal {
namespace {

/// The costs that a recording states of a controller.
ControlTimes costs_in(const TraceChannel& channel) {
  const ChannelName name = ChannelName::parse(channel.topic);
  ControlTimes control{name.body + "/" + name.owner};
  control.costs.emplace();
  for (std::size_t row = 0; row < channel.times.size(); ++row) {
    msg::ControlCost cost;
    std::size_t column = 0;
    for (const CostField& field : cost_fields) cost.*field.count = channel.bits(row, column++);
    const bool is_first = channel.times[row] == 0;
    control.costs->add(is_first ? 0 : static_cast<std::int64_t>(row), cost, 0);
    ++control.calls;
  }
  return control;
}

}  // namespace

bool wants_realtime() {
  const char* set = std::getenv("REHEARSE_REALTIME");
  return set && std::string_view(set) == "1";
}

TestVerdict judge_realtime(const std::vector<ControlTimes>& all) {
  TestVerdict verdict{true, {}};
  for (const ControlTimes& control : all) {
    if (control.costs && control.costs->is_realtime_safe()) continue;
    verdict.passed = false;
    verdict.message += control.costs ? realtime_sentence(control)
                                     : fmt::format("the costs of control() of {} can't be counted here: {}",
                                                   control.controller, why_no_costs);
    verdict.message += "\n";
  }
  return verdict;
}

TestVerdict judge_realtime(const Trace& trace) {
  std::vector<ControlTimes> all;
  for (const TraceChannel& channel : trace.channels())
    if (ChannelName::parse(channel.topic).kind == ChannelKind::cost) all.push_back(costs_in(channel));
  if (all.empty())
    return {false,
            fmt::format("{} has no costs of control(): the scenario needs `realtime: counts`, or the environment "
                        "REHEARSE_REALTIME=1",
                        trace.file())};
  TestVerdict verdict = judge_realtime(all);
  if (!verdict.passed) verdict.message += fmt::format("the lines: rehearse audit --realtime {}", trace.file());
  return verdict;
}

TestVerdict judge_realtime(const ControllerBench& bench) {
  std::string problem = bench.realtime_problem();
  return {problem.empty(), std::move(problem)};
}

}  // namespace rehearse::internal
