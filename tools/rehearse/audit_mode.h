// Modes of `rehearse audit` that are options of other verbs, too.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"

namespace rehearse::tool {

/// Executes `rehearse audit RECORDINGS MODE` with this verb's given options. Returns only on failure: an option that
/// the mode doesn't have, or a build without the wing audit. `mode`: "--instructions" or "--coverage"; `more`: further
/// arguments of audit.
Exit continue_in_audit(std::string_view mode, const std::vector<std::filesystem::path>& recordings,
                       const CLI::App& options, const std::vector<std::string>& more = {});

/// Declares --lcov of a verb that has --coverage.
void add_lcov_option(CLI::App& options, std::string& file);

}  // namespace rehearse::tool
