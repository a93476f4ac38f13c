// Options that several verbs share, and numbers on the command line, which are read without the locale.
#pragma once

#include <rehearse/run_options.h>
#include <rehearse/urdf.h>

#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/trace/select.h"

namespace rehearse::tool {

/// `text` as a number from `lowest` to `highest`; else throws CLI::ValidationError, naming `option`.
double parse_number(const std::string& option, std::string_view text, double lowest, double highest);
std::int64_t parse_integer(const std::string& option, std::string_view text, std::int64_t lowest, std::int64_t highest);

inline constexpr double longest_time = 1e9;  // upper limit of options that are times [s]

/// Declares an option with a number, which is passed to `take`. `option` is its long form, as "--until".
void add_number(CLI::App& options, const std::string& option, const std::string& help, double lowest, double highest,
                std::function<void(double)> take);
CLI::Option* add_integer(CLI::App& options, const std::string& option, const std::string& help, std::int64_t lowest,
                         std::int64_t highest, std::function<void(std::int64_t)> take);

/// Declares --controller NAME=LIB, any number of times, and --call-limit S. `alone`: receives a --controller LIB
/// without a name; if it is null, a missing name is an error.
void add_host_options(CLI::App& options, HostOptions& host, std::string* alone = nullptr);

/// Declares the options of verbs that load a model: --package NAME=DIR or --variable NAME=DIR, any number of times,
/// --allow-missing-meshes, --allow-unknown-devices, --mesh-up and --default-mass.
void add_model_options(CLI::App& options, UrdfOptions& urdf);

/// Declares --topics, --from, --until and --ticks: a selection of a file's messages.
void add_selection_options(CLI::App& options, mcap::Selection& selection);

/// Times of a recording or a log on the command line.
struct TimeSpan {
  std::optional<mcap::TimeBound> from, until;

  bool is_all() const { return !from && !until; }
};
/// The same from the beginning of a recording on [s].
struct SecondsSpan {
  std::optional<double> from, until;
};

/// Declares an option with a time: seconds from the log's beginning, or a date. `help` describes it without its form.
void add_time(CLI::App& options, const std::string& option, const std::string& help,
              std::function<void(mcap::TimeBound)> take);
/// Declares --from and --until.
void add_time_span(CLI::App& options, TimeSpan& span, const std::string& from, const std::string& until);
/// The span in a recording. Fails if it can't be read, has no dates, or the span is empty.
Result<SecondsSpan> seconds_in(const TimeSpan& span, const std::string& recording);

/// Declares --json.
void add_json_flag(CLI::App& options, bool& json);

}  // namespace rehearse::tool
