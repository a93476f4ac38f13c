#include "topic_watch.h"

#include "model/clock.h"

#include <cmath>
#include <utility>

namespace rehearse {

TopicWatch::TopicWatch(std::optional<double> max_age, std::int64_t period) : period_(period) {
  if (max_age) max_age_ = std::llround(*max_age * 1e9);
}

bool TopicWatch::came(std::int64_t time) {
  ++counts_.messages;
  if (last_ && time < *last_) {
    ++counts_.backwards;
    return false;
  }
  if (!first_) first_ = time;
  if (last_) {
    counts_.same_stamp += time == *last_ ? 1 : 0;
    if (time - *last_ > longest_gap_) {
      longest_gap_ = time - *last_;
      longest_gap_at_ = *last_;
    }
  }
  last_ = time;
  waiting_.push_back({time, false});
  return true;
}

TopicWatch::Age TopicWatch::look(std::int64_t time, double seconds, bool both_sides) {
  bool fresh = false;
  while (!waiting_.empty() && waiting_.front().time <= time) {
    current_ = waiting_.front().time;
    current_used_ = waiting_.front().used;
    counts_.used += current_used_ ? 1 : 0;
    waiting_.pop_front();
    fresh = true;
  }
  if (!current_) {
    ++counts_.ticks_without;
    return Age::none_yet;
  }
  if (!current_used_) ++counts_.used;
  current_used_ = true;
  if (both_sides && !waiting_.empty() && *current_ < time) waiting_.front().used = true;
  const std::int64_t age = time - *current_;
  const bool is_next_in_time = !waiting_.empty() && waiting_.front().time - *current_ < period_ + period_ / 2;
  may_miss_ = period_ > 0 && age >= period_ / 2 && !is_next_in_time;
  if (seconds_of(age) > counts_.worst_age) {
    counts_.worst_age = seconds_of(age);
    counts_.worst_age_at = seconds;
  }
  const bool was_in_gap = std::exchange(in_gap_, max_age_ && age > *max_age_);
  if (!in_gap_) return fresh ? Age::fresh : Age::held;
  ++counts_.ticks_in_gaps;
  counts_.gaps += was_in_gap ? 0 : 1;
  return was_in_gap ? Age::gap : Age::gap_begins;
}

void TopicWatch::report(LogTopicReport& report, std::int64_t start) const {
  report.messages = counts_.messages;
  report.used = counts_.used;
  report.same_stamp = counts_.same_stamp;
  report.backwards = counts_.backwards;
  report.worst_age = counts_.worst_age;
  report.worst_age_at = counts_.worst_age_at;
  report.gaps = counts_.gaps;
  report.ticks_in_gaps = counts_.ticks_in_gaps;
  report.ticks_without = counts_.ticks_without;
  for (const Waiting& waiting : waiting_) report.used += waiting.used ? 1 : 0;
  report.skipped = report.messages - report.used - report.backwards;
  report.longest_gap = seconds_of(longest_gap_);
  report.longest_gap_at = longest_gap_ > 0 ? seconds_of(longest_gap_at_ - start) : 0.0;
  const std::int64_t counted = report.messages - report.backwards;
  if (counted > 1 && *last_ > *first_) report.rate = static_cast<double>(counted - 1) / seconds_of(*last_ - *first_);
}

}  // namespace rehearse
