// Converts recorded messages of devices back to the devices' readings.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/model.h>

#include "core/kinds/channel_name.h"

namespace rehearse {

/// True if replays read messages of this kind as measurements of the device.
bool is_read_from(const Device& device, ChannelKind kind);

/// Sets the measured values of `device` and their time. `kind`: kind of the message's channel; `time_step` [s]. Fails
/// if the message isn't of this device, or a picture can't be decoded.
Result<void> read_device(const Device& device, ChannelKind kind, const mcap::Message& message, double time_step,
                         DeviceReading& reading);

}  // namespace rehearse
