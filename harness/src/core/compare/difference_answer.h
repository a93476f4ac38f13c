// Differences as answers between processes (core/guard/answer.h). Internal.
#pragma once

#include <rehearse/compare.h>

#include "core/guard/answer.h"

namespace rehearse {

void each_member(Passed<Divergence> auto& value, auto& each) {
  auto& [tick, time, channel, element, expected, actual, difference, ulps, tolerance, distance, unit, note, stage] =
      value;
  each(tick), each(time), each(channel), each(element), each(expected), each(actual), each(difference), each(ulps);
  each(tolerance), each(distance), each(unit), each(note), each(stage);
}

/// The members of a struct's base Differences.
void each_difference(auto& value, auto& each) {
  each(value.values), each(value.values_different), each(value.first), each(value.worst), each(value.beyond);
  each(value.largest), each(value.most_ulps);
}

}  // namespace rehearse
