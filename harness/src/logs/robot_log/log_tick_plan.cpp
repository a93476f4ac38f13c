#include "log_tick_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/clock.h"

namespace rehearse {

int TickPlan::steadiest_input(const std::vector<MappedSource>& sources, const LogSurvey& survey) {
  int best = -1;
  double best_spread = 0.0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const DurationCounts& gaps = survey.sources[i].before_commands;
    if (!gaps.is_regular() || gaps.median() == 0) continue;
    const double spread = static_cast<double>(gaps.quantile(0.9) - gaps.quantile(0.1));
    if (best >= 0 && spread >= best_spread) continue;
    best = static_cast<int>(i);
    best_spread = spread;
  }
  return best;
}

Result<TickPlan> TickPlan::make(const LogMap& map, const std::vector<MappedSource>& sources, const LogSurvey& survey) {
  TickPlan plan(map);
  const TickSource& tick = *map.tick;
  plan.regular_ = regular_times(survey.tick_messages, map.time_step);
  plan.latency_ = survey.latencies.median();
  if (!tick.grid && !tick.before_commands) return plan;
  if (tick.latency) {
    plan.latency_ = std::llround(*tick.latency * 1e9);
    plan.shift_ = -plan.latency_;
    plan.of_trigger_ = plan.of_others_ = {plan.regular_.jitter, plan.regular_.jitter};
    return plan;
  }
  int input = -1;
  if (tick.before_commands) {
    input = steadiest_input(sources, survey);
    if (input < 0)
      return at(tick.place, error("the latency of the commands can't be measured: no input comes at a regular time "
                                  "before them",
                                  "expected latency: the time from a tick to its command [s]"));
  } else {
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (sources[i].source->topic == tick.topic && sources[i].is_awaited()) input = static_cast<int>(i);
  }
  const DurationCounts* gaps = input < 0 ? nullptr : &survey.sources[input].before_commands;
  // Without commands after it, a grid is half a step after its messages.
  const bool is_measured = gaps && gaps->is_regular();
  const std::int64_t gap = is_measured ? gaps->median() : std::llround(map.time_step * 1e9);
  plan.latency_ = gap - gap / 2;
  plan.shift_ = tick.before_commands ? -plan.latency_ : gap / 2;
  plan.of_others_ = {gap / 2, plan.latency_};
  // On a grid a message is off by its own jitter; hardly any message by over twice that of nine of ten.
  std::int64_t nearest = is_measured ? gaps->quantile(0.05) - plan.latency_ : gap / 2;
  if (tick.grid || !is_measured) nearest -= 2 * plan.regular_.jitter;
  // A late message of a regular topic: the next one is further away.
  const std::int64_t step = std::llround(map.time_step * 1e9);
  const std::int64_t late = std::min(step / 2, (step - plan.latency_) * 3 / 4);
  plan.of_trigger_ = {std::max<std::int64_t>(0, nearest), std::max(plan.latency_, late)};
  if (is_measured) plan.trigger_ = sources[input].source->topic;
  return plan;
}

LogTicks TickPlan::ticks(const std::vector<std::int64_t>& messages, std::int64_t start) const {
  if (!tick_.grid) return LogTicks::at_messages(messages, start, time_step_, shift_, skips_missing_);
  return LogTicks::at_regular_times(regular_, shift_, start, messages.back(), time_step_);
}

TickWindow TickPlan::window_of(const std::string& topic) const { return topic == trigger_ ? of_trigger_ : of_others_; }

LogTickReport TickPlan::report() const {
  LogTickReport report;
  report.topic = tick_.topic;
  report.is_grid = tick_.grid;
  report.rate = 1e9 / regular_.period;
  report.drift = regular_.period / (time_step_ * 1e9) - 1.0;
  report.jitter = seconds_of(regular_.jitter);
  report.phase = seconds_of(shift_);
  if (latency_ > 0) report.latency = seconds_of(latency_);
  if (shift_ != 0 && !tick_.latency) report.measured_by = trigger_;
  return report;
}

}  // namespace rehearse
