// DeviceRecorder: records the measurements of one device as messages of a trace.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trace_output.h"

namespace rehearse {

class DeviceRecorder {
 public:
  /// Adds the device's channels; the state of a light is recorded when a controller has changed it. The device must
  /// outlive this.
  DeviceRecorder(TraceOutput& output, const Scenario& scenario, const ScenarioBody& body, const Device& device);
  /// Adds the channel of the true values, of a device that measures in each step. Must be called after all devices of
  /// the body have their channels.
  void declare_truth(TraceOutput& output, const ScenarioBody& body);
  /// Records the true values, if they have a channel.
  Result<void> write_truth(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) const;
  /// Records a reading that is fresh at this tick.
  Result<void> write(TraceOutput& output, std::int64_t tick, const DeviceReading& reading);

 private:
  struct Channel {
    std::uint16_t id;
    const ChannelForm* form;
    std::optional<FixedMessage> values;  // nullopt: its messages have more than the tick's stamp and the values
  };

  const Device* device_;
  std::string frame_;
  std::vector<Channel> channels_;
  std::optional<std::uint16_t> truth_;  // channel
};

}  // namespace rehearse
