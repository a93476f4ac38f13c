// Divergences and diagnostics as JSON between two processes of Rehearse. For people and other programs see to_json() of
// compare.h.
#pragma once

#include <rehearse/compare.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace rehearse {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Diagnostic, file, line, column, message, hint)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Divergence, tick, time, channel, element, expected, actual, difference, ulps,
                                   tolerance, unit, note)

/// JSON has no infinity and no NaN: a large number replaces them.
inline double finite(double value) { return std::isfinite(value) ? value : 1e300; }

/// Null: none.
inline nlohmann::json json_of_place(std::optional<Divergence> place) {
  if (!place) return nullptr;
  for (double* number : {&place->expected, &place->actual, &place->difference}) *number = finite(*number);
  nlohmann::json json = *place;
  if (place->distance_from_envelope) json["beside"] = finite(*place->distance_from_envelope);
  return json;
}

/// Throws nlohmann::json::exception if a member is missing or has another type.
inline std::optional<Divergence> place_of_json(const nlohmann::json& json) {
  if (json.is_null()) return std::nullopt;
  auto place = json.get<Divergence>();
  if (json.contains("beside")) place.distance_from_envelope = json.at("beside").get<double>();
  return place;
}

}  // namespace rehearse
