// How long controllers take for control(), for record, replay and check.
#pragma once

#include <rehearse/run_options.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

#include "output.h"

namespace rehearse::tool {

/// Declares --deadline and --realtime; `deadline` becomes the number of seconds.
void add_timing_options(CLI::App& options, std::optional<double>& deadline, HostOptions& host);

/// Prints a line for each controller, and its costs if they were counted.
void tell_control_times(const std::vector<ControlTimes>& all);

/// Warns on stderr of each controller whose longest call exceeds the deadline; does nothing without a deadline.
void tell_missed_deadlines(const std::vector<ControlTimes>& all, std::optional<double> deadline);

/// A list of objects; times in seconds.
Json json_of(const std::vector<ControlTimes>& all);

}  // namespace rehearse::tool
