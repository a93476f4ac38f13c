// The file of an order in which threads of controllers take turns, and the exchanges that a run made. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/turns/turn_order.h"

namespace rehearse {

/// The first bytes of such a file.
inline constexpr std::string_view turn_order_magic = "{\n \"file\": \"an order of threads of Rehearse\"";

/// An exchange with its threads, as in a file of an order: "'planner' (walk.cpp:88)".
struct NamedExchange {
  Exchange exchange;
  std::string runs, before;  // `runs` comes first, which had come after `before`
};

nlohmann::ordered_json json_of_order(const std::vector<NamedExchange>& exchanges);
nlohmann::ordered_json json_of_drawn_order(std::uint64_t seed, const std::vector<std::int64_t>& changes);
/// Throws nlohmann::json::exception if a member is missing or has another type.
std::vector<NamedExchange> exchanges_of_json(const nlohmann::ordered_json& json);
/// Threads of this process and of those that it starts take turns in the order of the file. Fails if the file can't be
/// read, or isn't one of an order.
Result<void> take_turn_order(const std::filesystem::path& file);

/// Adds the lines of the source to the exchanges since the last call of this function, while the libraries are loaded.
void find_lines_of_exchanges();
/// The exchanges that the run made.
std::vector<NamedExchange> made_exchanges();

}  // namespace rehearse
