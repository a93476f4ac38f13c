// The executed code of controllers' libraries as JSON between two processes of Rehearse.
#pragma once

#include <rehearse/coverage.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace rehearse {

using ExecutedLibraries = std::map<std::filesystem::path, ExecutedCode>;

inline nlohmann::json json_of_executed_code(const ExecutedLibraries& libraries) {
  const auto json_of_tick = [](std::optional<std::int64_t> tick) {
    return tick ? nlohmann::json(*tick) : nlohmann::json(nullptr);
  };
  nlohmann::json json = nlohmann::json::array();
  for (const auto& [file, code] : libraries) {
    nlohmann::json jumps = nlohmann::json::array();
    for (const auto& [address, jump] : code.jumps)
      jumps.push_back({address, json_of_tick(jump.taken), json_of_tick(jump.passed), jump.is_complete});
    json.push_back({{"library", file.string()}, {"statements", code.statements}, {"jumps", jumps}});
  }
  return json;
}

/// Throws nlohmann::json::exception if a member is missing or has another type.
inline ExecutedLibraries executed_code_of_json(const nlohmann::json& json) {
  const auto tick_of_json = [](const nlohmann::json& tick) {
    return tick.is_null() ? std::nullopt : std::optional(tick.get<std::int64_t>());
  };
  ExecutedLibraries libraries;
  for (const nlohmann::json& library : json) {
    ExecutedCode& code = libraries[library.at("library").get<std::string>()];
    library.at("statements").get_to(code.statements);
    for (const nlohmann::json& jump : library.at("jumps"))
      code.jumps[jump.at(0)] = {tick_of_json(jump.at(1)), tick_of_json(jump.at(2)), jump.at(3)};
  }
  return libraries;
}

}  // namespace rehearse
