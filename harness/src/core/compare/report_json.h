// Verdicts as JSON: functions that the reports of comparisons and checks share. Internal.
#pragma once

#include <rehearse/compare.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace rehearse {

/// Null, or an object as to_json(Divergence).
nlohmann::ordered_json json_of(const std::optional<Divergence>& divergence);

/// An object as to_json(Comparison).
nlohmann::ordered_json json_of(const Comparison& comparison);

/// NaN and infinities, which JSON doesn't have, as strings.
inline nlohmann::ordered_json number_json(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  return value;
}

/// Indented, without a final newline.
std::string text_of(const nlohmann::ordered_json& object);

}  // namespace rehearse
