// Words of the command line about scenarios: names of scenarios, and other values in them.
#pragma once

#include <rehearse/diagnostic.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace rehearse::tool {

/// The files that a word names: a file, the scenarios below a folder that may be checked, or the scenario of this
/// folder's project with that name or golden. Fails with the nearest names.
Result<std::vector<std::string>> files_named(const std::string& word);
/// The files of several words, in their order.
Result<std::vector<std::string>> files_named(const std::vector<std::string>& words);

/// The files of this folder's project that may name a golden or have expectations: the failures that it keeps, then its
/// scenarios, each by path.
Result<std::vector<std::string>> files_of_project();
Diagnostic nothing_to_check();

/// Other values in a scenario, by paths as in `vary:`.
using StatedValues = std::vector<std::pair<std::string, std::string>>;

/// Declares --with PATH=VALUE.
void add_value_option(CLI::App& options, StatedValues& values);

}  // namespace rehearse::tool
