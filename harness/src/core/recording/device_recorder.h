// DeviceRecorder: records the measurements of one device as messages of a trace.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <string>
#include <vector>

#include "trace_output.h"

namespace rehearse {

class DeviceRecorder {
 public:
  /// Adds the device's channels; the state of a light is recorded when a controller has changed it. The device must
  /// outlive this.
  DeviceRecorder(TraceOutput& output, const Scenario& scenario, const ScenarioBody& body, const Device& device);
  /// Records a reading that is fresh at this tick.
  Result<void> write(TraceOutput& output, std::int64_t tick, const DeviceReading& reading) const;

 private:
  struct Channel {
    std::uint16_t id;
    const ChannelForm* form;
  };

  const Device* device_;
  std::string frame_;
  std::vector<Channel> channels_;
};

}  // namespace rehearse
