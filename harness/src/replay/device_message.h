// DeviceMessage: converts a recorded message of a device back to the device's reading.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>

#include "trace/channel_name.h"

namespace rehearse {

class DeviceMessage {
 public:
  /// All references must outlive this. `kind`: kind of the message's channel; `time_step` [s].
  DeviceMessage(const Device& device, ChannelKind kind, const mcap::Message& message, double time_step)
      : device_(device), kind_(kind), message_(message), time_step_(time_step) {}

  /// Sets the measured values and their time. Fails if the message isn't of this device, or a picture can't be decoded.
  Result<void> read(DeviceReading& reading) const;

 private:
  template <class T>
  bool decode(T& message) const;
  double measured_at(const msg::Time& stamp) const;
  bool read_values(DeviceReading& reading) const;
  bool read_inertial(DeviceReading& reading) const;
  bool read_ranges(const RangeSensor& laser, DeviceReading& reading) const;
  bool read_depth(DeviceReading& reading) const;
  Result<void> read_color(DeviceReading& reading) const;
  Diagnostic mismatch() const;

  const Device& device_;
  const ChannelKind kind_;
  const mcap::Message& message_;
  const double time_step_;
};

}  // namespace rehearse
