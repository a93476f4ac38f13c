// Times and costs of control() as answers between processes (core/guard/answer.h). Internal.
#pragma once

#include <rehearse/run_options.h>

#include <set>
#include <string>
#include <utility>

#include "core/guard/answer.h"

namespace rehearse {

inline void each_member(const ControlCosts::Count& value, AnswerWriter& each) {
  auto& [name, total, ticks, first_tick] = value;
  each(name), each(total), each(ticks), each(first_tick);
}

/// Names of counts are constants of the program.
inline void each_member(ControlCosts::Count& value, AnswerReader& each) {
  static auto& names = *new std::set<std::string>;
  auto& [name, total, ticks, first_tick] = value;
  std::string passed;
  each(passed), each(total), each(ticks), each(first_tick);
  name = *names.insert(std::move(passed)).first;
}

void each_member(Passed<ControlCosts> auto& value, auto& each) {
  auto& [counts, page_faults] = value;
  each(counts), each(page_faults);
}

void each_member(Passed<ControlTimes> auto& value, auto& each) {
  auto& [controller, period, calls, median, p999, longest, longest_tick, histogram, costs] = value;
  each(controller), each(period), each(calls), each(median), each(p999), each(longest), each(longest_tick);
  each(histogram), each(costs);
}

}  // namespace rehearse
