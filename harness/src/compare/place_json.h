// A Divergence as JSON between two processes of Rehearse. For people and other programs see to_json() of compare.h.
#pragma once

#include <rehearse/compare.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace rehearse {

/// JSON has no infinity and no NaN: a large number replaces them.
inline double finite(double value) { return std::isfinite(value) ? value : 1e300; }

inline nlohmann::json json_of_place(const std::optional<Divergence>& place) {
  if (!place) return nullptr;
  return {{"tick", place->tick},
          {"time", place->time},
          {"channel", place->channel},
          {"element", place->element},
          {"expected", finite(place->expected)},
          {"actual", finite(place->actual)},
          {"difference", finite(place->difference)},
          {"ulps", place->ulps},
          {"tolerance", place->tolerance},
          {"unit", place->unit},
          {"note", place->note}};
}

inline std::optional<Divergence> place_of_json(const nlohmann::json& json) {
  if (json.is_null()) return std::nullopt;
  Divergence place;
  json.at("tick").get_to(place.tick);
  json.at("time").get_to(place.time);
  json.at("channel").get_to(place.channel);
  json.at("element").get_to(place.element);
  json.at("expected").get_to(place.expected);
  json.at("actual").get_to(place.actual);
  json.at("difference").get_to(place.difference);
  json.at("ulps").get_to(place.ulps);
  json.at("tolerance").get_to(place.tolerance);
  json.at("unit").get_to(place.unit);
  json.at("note").get_to(place.note);
  return place;
}

}  // namespace rehearse
