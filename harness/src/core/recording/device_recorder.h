// DeviceRecorder: records the measurements of one device as messages of a trace.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <string>

#include "trace_output.h"

namespace rehearse {

/// The frame of a range sensor's messages: the origin of the device frame, with the axes of ROS.
std::string scan_frame(const std::string& body, const Device& device);

class DeviceRecorder {
 public:
  /// Adds the device's channels; the state of a light is recorded when a controller has changed it. Scenario and device
  /// must outlive this.
  DeviceRecorder(TraceOutput& output, const Scenario& scenario, const ScenarioBody& body, const Device& device);
  /// Records a reading that is fresh at this tick.
  Result<void> write(TraceOutput& output, std::int64_t tick, const DeviceReading& reading) const;

 private:
  Result<void> write_inertial(TraceOutput& output, std::int64_t tick, const DeviceReading& reading) const;
  Result<void> write_ranges(TraceOutput& output, std::int64_t tick, const RangeSensor& laser,
                            const DeviceReading& reading) const;
  Result<void> write_pictures(TraceOutput& output, std::int64_t tick, const Camera& camera,
                              const DeviceReading& reading) const;
  Result<void> write_color(TraceOutput& output, std::int64_t tick, const msg::Header& header,
                           const std::shared_ptr<const Image>& image) const;

  const Device* device_;
  std::string frame_;
  // channels; 0: none
  std::uint16_t measured_ = 0;  // channel of values or ranges
  std::uint16_t color_ = 0;
  std::uint16_t info_ = 0;
  std::uint16_t depth_ = 0;
};

}  // namespace rehearse
