#include "options.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "base/text.h"

namespace rehearse::tool {
namespace {

template <class Number>
Number parse(const std::string& option, std::string_view text, Number lowest, Number highest, const char* kind) {
  const auto number = number_in<Number>(text);
  if (number && *number >= lowest && *number <= highest) return *number;  // false for NaN
  throw CLI::ValidationError(option, fmt::format("'{}' is not {} from {} to {}", text, kind, lowest, highest));
}

/// Adds NAME=VALUE to a map; `form`: as the help of `option` shows it.
template <class Map>
void take_pair(Map& pairs, const char* option, const char* form, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw CLI::ValidationError(option, fmt::format("'{}' is not {}", text, form));
  const std::string name = text.substr(0, equals);
  if (!pairs.emplace(name, text.substr(equals + 1)).second)
    throw CLI::ValidationError(option, fmt::format("'{}' is given twice", name));
}

}  // namespace

double parse_number(const std::string& option, std::string_view text, double lowest, double highest) {
  return parse(option, text, lowest, highest, "a number");
}

std::int64_t parse_integer(const std::string& option, std::string_view text, std::int64_t lowest,
                           std::int64_t highest) {
  return parse(option, text, lowest, highest, "a whole number");
}

void add_number(CLI::App& options, const std::string& option, const std::string& help, double lowest, double highest,
                std::function<void(double)> take) {
  const auto read = [=](const std::string& text) { take(parse_number(option, text, lowest, highest)); };
  options.add_option_function<std::string>(option, read, help)->type_name("NUMBER");
}

CLI::Option* add_integer(CLI::App& options, const std::string& option, const std::string& help, std::int64_t lowest,
                         std::int64_t highest, std::function<void(std::int64_t)> take) {
  const auto read = [=](const std::string& text) { take(parse_integer(option, text, lowest, highest)); };
  return options.add_option_function<std::string>(option, read, help)->type_name("NUMBER");
}

void add_host_options(CLI::App& options, HostOptions& host, std::string* alone) {
  const auto take_all = [&host, alone](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      if (!alone || text.find('=') != std::string::npos) {
        take_pair(host.libraries, "--controller", "NAME=LIB", text);
      } else if (alone->empty() && !text.empty()) {
        *alone = text;
      } else {
        throw CLI::ValidationError("--controller", "a library without a name of its own is given twice, or is empty");
      }
    }
  };
  const char* help = "another library (a name or a path) for the controller NAME or BODY/NAME";
  const char* help_of_logs =
      "another library (a name or a path) for the controller NAME or BODY/NAME; of a log, a flight or a --model: LIB "
      "alone";
  options.add_option_function<std::vector<std::string>>("--controller", take_all, alone ? help_of_logs : help)
      ->type_name("NAME=LIB")
      ->allow_extra_args(false);
  add_number(options, "--call-limit", "a controller's call that takes longer has hung [s of wall time] (10)", 0.01,
             86400.0, [&host](double limit) { host.call_limit = limit; });
  add_number(options, "--memory-limit",
             "the process with the controllers ends if it takes more memory [MB] (four fifths of the available memory)",
             1.0, 1e9, [&host](double limit) { host.memory_limit = limit; });
}

void add_model_options(CLI::App& options, UrdfOptions& urdf) {
  const auto take_packages = [&urdf](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) take_pair(urdf.packages, "--package", "NAME=DIR", text);
  };
  options
      .add_option_function<std::vector<std::string>>(
          "--package,--variable", take_packages,
          "the directory that package://NAME, or ${NAME} in a body or project, means")
      ->type_name("NAME=DIR")
      ->allow_extra_args(false);
  options.add_flag("--allow-missing-meshes", urdf.allow_missing_meshes,
                   "meshes that can't be loaded are left out, with a warning");
  options.add_flag("--allow-unknown-devices", urdf.allow_unknown_devices,
                   "elements of a body that are no known devices are left out, with a warning each");
  options.add_flag("--allow-unsupported", urdf.allow_unsupported,
                   "what a MuJoCo model has beyond this program is left out, with a note each");
  options
      .add_option_function<std::string>(
          "--mesh-up", [&urdf](const std::string& axis) { urdf.mesh_z_up = axis == "z"; },
          "the axis that glTF meshes have up; their standard says y (y)")
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("AXIS");
  add_number(options, "--default-mass", "of links that move and have none [kg]", 1e-9, 1e9,
             [&urdf](double mass) { urdf.default_mass = mass; });
}

namespace {

/// CLI11 prints the option's name before the message of an error.
template <class Parsed>
auto taken(const std::string& option, Parsed parsed) {
  if (parsed) return std::move(*parsed);
  throw CLI::ValidationError(option, fmt::format("{} ({})", parsed.errors()[0].message, parsed.errors()[0].hint));
}

}  // namespace

void add_time(CLI::App& options, const std::string& option, const std::string& help,
              std::function<void(mcap::TimeBound)> take) {
  const std::string form = option == "--until"
                               ? ", in the form of --from"
                               : ": seconds from the log's beginning, or a date, as 2026-11-26T12:00:00Z; +S counts "
                                 "from the first message";
  const auto read = [=](const std::string& text) { take(taken(option, mcap::parse_time_bound(text))); };
  options.add_option_function<std::string>(option, read, help + form)->type_name("TIME");
}

void add_time_span(CLI::App& options, TimeSpan& span, const std::string& from, const std::string& until) {
  add_time(options, "--from", from, [&span](mcap::TimeBound time) { span.from = time; });
  add_time(options, "--until", until, [&span](mcap::TimeBound time) { span.until = time; });
}

Result<SecondsSpan> seconds_in(const TimeSpan& span, const std::string& recording) {
  SecondsSpan seconds;
  if (span.is_all()) return seconds;
  auto reader = REHEARSE_TRY(mcap::Reader::open(recording));
  if (span.from) {
    seconds.from = REHEARSE_TRY(mcap::seconds_in(*span.from, *reader));
  }
  if (span.until) {
    seconds.until = REHEARSE_TRY(mcap::seconds_in(*span.until, *reader));
  }
  const auto times = mcap::log_times(*reader);
  const bool is_after = times && seconds.from && *seconds.from > static_cast<double>(times->second) * 1e-9;
  if (is_after || (seconds.until && *seconds.until <= seconds.from.value_or(0.0)))
    return mcap::refusal_of_empty(*reader);
  return seconds;
}

void add_selection_options(CLI::App& options, mcap::Selection& selection) {
  options
      .add_option("--topics", selection.topics,
                  "only topics that match one of these patterns; * stands for any text, slashes included")
      ->type_name("GLOB");
  add_time(options, "--from", "only messages from this time on",
           [&selection](mcap::TimeBound time) { selection.from = time; });
  add_time(options, "--until", "only messages before this time",
           [&selection](mcap::TimeBound time) { selection.until = time; });
  options
      .add_option_function<std::string>(
          "--ticks",
          [&selection](const std::string& text) { selection.ticks = taken("--ticks", mcap::parse_tick_span(text)); },
          "only what was recorded in these ticks, both included; A.. and ..B have no other end")
      ->type_name("A..B");
}

void add_json_flag(CLI::App& options, bool& json) {
  options.add_flag("--json", json, "print one JSON object, and nothing else, on stdout");
}

}  // namespace rehearse::tool
