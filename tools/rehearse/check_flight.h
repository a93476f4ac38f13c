// check SCENARIO --flight FLIGHT: a scenario's controller and its world beside a robot.
#pragma once

#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <string>

#include "command.h"

namespace rehearse::tool {

/// Replays the flight into the scenario's controller, and compares the scenario's world with the robot step by step.
/// Prints both, `json`: as an object. Status 1: one of them differs; 4: the world's state isn't known.
Exit check_with_flight(const Scenario& scenario, const std::string& flight, const HostOptions& host, bool json);

}  // namespace rehearse::tool
