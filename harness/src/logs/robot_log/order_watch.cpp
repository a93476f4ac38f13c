#include "order_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rehearse {

OrderWatch::OrderWatch(double time_step) : step_(std::llround(time_step * 1e9)) {}

void OrderWatch::add(const mcap::Message& message, std::optional<std::int64_t> stamp) {
  constexpr std::int64_t times_usual = 4;
  const auto is_behind = [](const mcap::Location& a, const mcap::Location& b) {
    return a.record != b.record ? a.record > b.record : a.inside > b.inside;
  };
  const auto time = static_cast<std::int64_t>(message.log_time);
  bool is_odd = place_ && is_behind(*place_, message.location);
  std::int64_t late = 0;
  place_ = message.location;
  if (stamp) {
    const std::int64_t delay = time - *stamp;
    is_odd |= stamp_ && *stamp <= *stamp_;
    if (delay_) {
      const std::int64_t change = std::abs(delay - *delay_);
      is_odd |= change > step_ / 5 && change > times_usual * changes_.median();
      late = std::max<std::int64_t>(0, delay - *delay_);
      changes_.add(change);
    }
    delay_ = delay;
  }
  stamp_ = stamp;
  if (is_odd) spans_.push_back({time - std::min(late, 10 * step_) - step_, time + step_});
}

bool OrderWatch::doubts(std::int64_t time) {
  while (!spans_.empty() && spans_.front().until < time) spans_.pop_front();
  return std::ranges::any_of(spans_, [time](const Span& span) { return span.from <= time && time <= span.until; });
}

}  // namespace rehearse
