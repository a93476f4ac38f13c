// What decides whether a replay can repeat its recording: that its inputs were recorded, and that controllers, files
// and arithmetic are what they were.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <string>
#include <vector>

#include "host/controller_host.h"
#include "recorded_inputs.h"

namespace rehearse {

/// What controllers read that the recording hasn't: an error each. The controllers have been initialised.
Diagnostics unrecorded_inputs(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host,
                              const RecordedInputs& inputs);
/// BODY/NAME of the controllers whose libraries aren't the recorded ones, by their hashes.
std::vector<std::string> other_controllers(const mcap::Reader& recording, const ControllerHost& host);
/// True if a recording of these controllers would have the channels of inputs and outputs that this one has, with their
/// metadata. The controllers have been initialised.
bool has_channels_of(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host);
/// Files that controllers read and that have changed since the recording, or may have: a sentence each.
std::vector<std::string> changed_files(const mcap::Reader& recording, const ControllerHost& host);
/// What may have made the last bits differ, if it isn't the controllers.
Diagnostics other_arithmetic_than(const mcap::Reader& recording, const Scenario& scenario);
/// That the recorded controllers had simulated time and random numbers, and these here have the system's.
Diagnostics other_clock_than(const mcap::Reader& recording);

}  // namespace rehearse
