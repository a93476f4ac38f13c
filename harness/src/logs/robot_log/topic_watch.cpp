#include "topic_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"

namespace rehearse {

GapWatch::GapWatch(std::optional<double> max_age) {
  if (max_age) max_age_ = std::llround(*max_age * 1e9);
}

bool GapWatch::look(std::int64_t age, double seconds) {
  if (seconds_of(age) > found_.worst_age) {
    found_.worst_age = seconds_of(age);
    found_.worst_age_at = seconds;
  }
  const bool was_in_gap = std::exchange(in_gap_, max_age_ && age > *max_age_);
  found_.ticks_in_gaps += in_gap_ ? 1 : 0;
  found_.gaps += in_gap_ && !was_in_gap ? 1 : 0;
  return in_gap_ && !was_in_gap;
}

bool misses_message(std::int64_t age, std::int64_t last, std::optional<std::int64_t> next, std::int64_t period) {
  return period > 0 && age >= period / 2 && !(next && *next - last < period + period / 2);
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

void TopicWatch::reject(std::int64_t time) {
  ++counts_.unreadable;
  const auto is_it = [time](const Waiting& waiting) { return waiting.time == time; };
  const auto found = std::ranges::find_if(waiting_.rbegin(), waiting_.rend(), is_it);
  if (found != waiting_.rend()) waiting_.erase(std::next(found).base());
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
  may_miss_ =
      misses_message(age, *current_, waiting_.empty() ? std::nullopt : std::optional(waiting_.front().time), period_);
  may_miss_ |= age < window_.before || (!waiting_.empty() && waiting_.front().time - time < window_.after);
  if (gaps_.look(age, seconds)) return Age::gap_begins;
  if (gaps_.is_in_gap()) return Age::gap;
  return fresh ? Age::fresh : Age::held;
}

void TopicWatch::report(LogTopicReport& report, std::int64_t start) const {
  report.messages = counts_.messages;
  report.used = counts_.used;
  report.same_stamp = counts_.same_stamp;
  report.backwards = counts_.backwards;
  static_cast<LogGaps&>(report) = gaps_.found();
  report.unreadable = counts_.unreadable;
  report.ticks_without = counts_.ticks_without;
  for (const Waiting& waiting : waiting_) report.used += waiting.used ? 1 : 0;
  report.skipped = report.messages - report.used - report.backwards - report.unreadable;
  report.longest_gap = seconds_of(longest_gap_);
  report.longest_gap_at = longest_gap_ > 0 ? seconds_of(longest_gap_at_ - start) : 0.0;
  const std::int64_t counted = report.messages - report.backwards;
  if (counted > 1 && *last_ > *first_) report.rate = static_cast<double>(counted - 1) / seconds_of(*last_ - *first_);
}

mcap::StringMap metadata_of(const LogTopicReport& topic) {
  std::vector<std::string> reasons, silent;
  for (const LogUnreadable& found : topic.unreadable_for)
    reasons.push_back(fmt::format("{} from {:.9g} s on: {}", found.messages, found.first_at, found.reason));
  for (const SilentJoint& joint : topic.silent_joints)
    silent.push_back(fmt::format("{}: {} gaps, {} ticks", joint.joint, joint.gaps, joint.ticks_in_gaps));
  return {{"unreadable_for", fmt::format("{}", fmt::join(reasons, "; "))},
          {"silent_joints", fmt::format("{}", fmt::join(silent, "; "))},
          {"use", topic.use},
          {"type", topic.type},
          {"messages", fmt::format("{}", topic.messages)},
          {"used", fmt::format("{}", topic.used)},
          {"skipped", fmt::format("{}", topic.skipped)},
          {"out_of_order", fmt::format("{}", topic.out_of_order)},
          {"same_stamp", fmt::format("{}", topic.same_stamp)},
          {"backwards", fmt::format("{}", topic.backwards)},
          {"unreadable", fmt::format("{}", topic.unreadable)},
          {"rate", fmt::format("{:.6g} Hz", topic.rate)},
          {"longest_gap", fmt::format("{:.9g} s from {:.9g} s on", topic.longest_gap, topic.longest_gap_at)},
          {"worst_age", fmt::format("{:.9g} s at {:.9g} s", topic.worst_age, topic.worst_age_at)},
          {"gaps", fmt::format("{}", topic.gaps)},
          {"ticks_in_gaps", fmt::format("{}", topic.ticks_in_gaps)},
          {"ticks_without", fmt::format("{}", topic.ticks_without)}};
}

}  // namespace rehearse
