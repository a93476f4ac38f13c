// Whether a check compared anything. A check that compared nothing is neither right nor wrong. Internal.
#pragma once

#include <rehearse/check.h>

namespace rehearse {

inline bool compared_anything(const CheckReport& report) {
  const auto has_values = [](const std::optional<Comparison>& compared) { return compared && compared->values > 0; };
  return !report.within() || report.golden_written || report.proved || !report.expectations.empty() ||
         (report.replay && report.replay->values > 0) || has_values(report.plant_comparison) ||
         has_values(report.comparison);
}

}  // namespace rehearse
