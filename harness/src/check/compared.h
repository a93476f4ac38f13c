// Whether a check compared anything at all: one that didn't has found nothing wrong, and nothing right. Internal.
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
