// Numbers in the JSON of reports. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace rehearse {

inline nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json json_of_interval(const Interval& interval) {
  return nlohmann::ordered_json::array({interval.low, interval.high});
}

}  // namespace rehearse
