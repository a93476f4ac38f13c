#include "options.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "model/text.h"

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

void add_integer(CLI::App& options, const std::string& option, const std::string& help, std::int64_t lowest,
                 std::int64_t highest, std::function<void(std::int64_t)> take) {
  const auto read = [=](const std::string& text) { take(parse_integer(option, text, lowest, highest)); };
  options.add_option_function<std::string>(option, read, help)->type_name("NUMBER");
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
      "another library (a name or a path) for the controller NAME or BODY/NAME; of a log or a --model: LIB alone";
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
  options
      .add_option_function<std::string>(
          "--mesh-up", [&urdf](const std::string& axis) { urdf.mesh_z_up = axis == "z"; },
          "the axis that glTF meshes have up; their standard says y (y)")
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("AXIS");
  add_number(options, "--default-mass", "of links that move and have none [kg]", 1e-9, 1e9,
             [&urdf](double mass) { urdf.default_mass = mass; });
}

void add_selection_options(CLI::App& options, mcap::Selection& selection) {
  // CLI11 prints the option's name before this message.
  const auto take = [](const std::string& option, auto parsed) {
    if (parsed) return std::move(*parsed);
    throw CLI::ValidationError(option, fmt::format("{} ({})", parsed.errors()[0].message, parsed.errors()[0].hint));
  };
  options
      .add_option("--topics", selection.topics,
                  "only topics that match one of these patterns; * stands for any text, slashes included")
      ->type_name("GLOB");
  options
      .add_option_function<std::string>(
          "--from",
          [=, &selection](const std::string& text) { selection.from = take("--from", mcap::parse_time_bound(text)); },
          "only messages from this time on: seconds from the log's beginning, or a date, as 2026-11-26T12:00:00Z; +S "
          "counts "
          "from the file's first message")
      ->type_name("TIME");
  options
      .add_option_function<std::string>(
          "--until",
          [=, &selection](const std::string& text) { selection.until = take("--until", mcap::parse_time_bound(text)); },
          "only messages before this time, likewise")
      ->type_name("TIME");
  options
      .add_option_function<std::string>(
          "--ticks",
          [=, &selection](const std::string& text) { selection.ticks = take("--ticks", mcap::parse_tick_span(text)); },
          "only what was recorded in these ticks, both included; A.. and ..B have no other end")
      ->type_name("A..B");
}

void add_json_flag(CLI::App& options, bool& json) {
  options.add_flag("--json", json, "print one JSON object, and nothing else, on stdout");
}

}  // namespace rehearse::tool
