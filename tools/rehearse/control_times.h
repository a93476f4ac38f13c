// How long controllers take for control(), for record, replay and check.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

#include "output.h"

namespace rehearse::tool {

/// Declares --deadline and --realtime.
void add_timing_options(CLI::App& options, std::optional<double>& deadline, HostOptions& host);

/// Declares --deadline; `deadline` becomes the number of seconds.
void add_deadline_option(CLI::App& options, std::optional<double>& deadline);

/// A line on the page faults of control(); none if there are none.
void tell_page_faults(const ControlCosts::Count& faults);

/// Prints a line for each controller, and its costs if they were counted.
void tell_control_times(const std::vector<ControlTimes>& all);

/// Warns on stderr of each controller whose longest call exceeds the deadline; does nothing without a deadline.
void tell_missed_deadlines(const std::vector<ControlTimes>& all, std::optional<double> deadline);

/// Of the closed loop that a check made, or else of its replay; empty: neither called control().
const std::vector<ControlTimes>& control_times_of(const CheckReport& report);

/// A list of objects; times in seconds.
Json json_of(const std::vector<ControlTimes>& all);

}  // namespace rehearse::tool
