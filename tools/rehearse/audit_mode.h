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

/// Output files of --coverage; empty: none.
struct CoverageFiles {
  std::string lcov;  // a tracefile
  std::string html;  // a page for a browser
};

/// Declares --lcov and --html of a verb that has --coverage.
void add_coverage_files(CLI::App& options, CoverageFiles& files);

}  // namespace rehearse::tool
