// Verdicts as JSON: what the reports of comparisons and checks have in common. Internal.
#pragma once

#include <rehearse/divergence.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace rehearse {

/// Null, or tick, time, channel, element, expected, actual, ulps and stage.
nlohmann::ordered_json json_of(const std::optional<Divergence>& divergence);

/// Indented, without a final newline.
std::string text_of(const nlohmann::ordered_json& object);

}  // namespace rehearse
