// A check's report as JSON, for programs of this project that add members to it. Internal.
#pragma once

#include <rehearse/check.h>

#include <nlohmann/json.hpp>

namespace rehearse {

/// An object as to_json(CheckReport).
nlohmann::ordered_json json_of(const CheckReport& report);
/// The differences of commands: first, beyond, worst, and their numbers.
nlohmann::ordered_json json_of(const ReplayReport& replayed);
/// The result of an expectation, with its margin.
nlohmann::ordered_json json_of(const ExpectationResult& result);

}  // namespace rehearse
