// The conditions under which a replay repeats its recording: all inputs were recorded, and controllers, files and
// arithmetic are unchanged.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <string>
#include <vector>

#include "core/host/controller_host.h"
#include "recorded_inputs.h"

namespace rehearse {

/// An error for each input that controllers read and the recording lacks. The controllers must be initialised.
Diagnostics unrecorded_inputs(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host,
                              const RecordedInputs& inputs);
/// BODY/NAME of the controllers whose libraries differ from the recorded libraries, by their hashes.
std::vector<std::string> other_controllers(const mcap::Reader& recording, const ControllerHost& host);
/// The inputs that only the recorded controllers read ("- Rig/Gyro"), then those that only these controllers read
/// ("+ SHOULDER/dq of Rig/C"). Older recordings don't state which devices were read: then the list has no devices. The
/// controllers must be initialised.
std::vector<std::string> other_inputs(const mcap::Reader& recording, const Scenario& scenario,
                                      const ControllerHost& host, const RecordedInputs& inputs);
/// True if a recording of these controllers would have the same channels of inputs and outputs as `recording`, with
/// equal metadata. The controllers must be initialised.
bool has_channels_of(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host);
/// A sentence for each file that controllers read and that has changed since the recording, or may have changed.
std::vector<std::string> changed_files(const mcap::Reader& recording, const ControllerHost& host);
/// Differences of this process's arithmetic that may change last bits without a change of the controllers.
Diagnostics other_arithmetic_than(const mcap::Reader& recording, const Scenario& scenario);
/// An error if the recorded controllers got simulated time and random numbers, and the controllers here get the
/// system's.
Diagnostics other_clock_than(const mcap::Reader& recording);

}  // namespace rehearse
