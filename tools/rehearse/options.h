// Options that several verbs share, and numbers on the command line: read without locale, and all refused alike.
#pragma once

#include <rehearse/host_options.h>
#include <rehearse/urdf.h>

#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "trace/select.h"

namespace rehearse::tool {

/// `text` as a number from `lowest` to `highest`; else throws CLI::ValidationError, naming `option`.
double parse_number(const std::string& option, std::string_view text, double lowest, double highest);
std::int64_t parse_integer(const std::string& option, std::string_view text, std::int64_t lowest, std::int64_t highest);

inline constexpr double longest_time = 1e9;  // of options that are times [s]

/// An option with a number, handed to `take`. `option` is its long form, as "--until".
void add_number(CLI::App& options, const std::string& option, const std::string& help, double lowest, double highest,
                std::function<void(double)> take);
void add_integer(CLI::App& options, const std::string& option, const std::string& help, std::int64_t lowest,
                 std::int64_t highest, std::function<void(std::int64_t)> take);

/// --controller NAME=LIB, as often as one likes, and --call-limit S. `alone`: takes a --controller LIB without a name;
/// null: that is a mistake.
void add_host_options(CLI::App& options, HostOptions& host, std::string* alone = nullptr);

/// --package NAME=DIR, as often as one likes, and --allow-missing-meshes.
void add_mesh_options(CLI::App& options, UrdfOptions& urdf);

/// --topics, --from, --until and --ticks: which messages of a file.
void add_selection_options(CLI::App& options, mcap::Selection& selection);

/// --json.
void add_json_flag(CLI::App& options, bool& json);

}  // namespace rehearse::tool
