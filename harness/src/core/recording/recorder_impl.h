// The channels of a Recorder, and the writing of their messages. Internal.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "contact_recorder.h"
#include "device_recorder.h"
#include "recorder.h"
#include "side_recorder.h"
#include "trace_output.h"

namespace rehearse {

class SupervisedWriter;

struct ControllerChannels {
  SideRecorder input, output;
  std::vector<std::uint16_t> contacts;                       // channels by the controller's contact links
  std::vector<std::optional<std::uint16_t>> devices;         // channels by device index
  std::optional<std::uint16_t> delay = {};                   // from the first command that acts at another time on
  std::vector<std::optional<std::uint16_t>> variables = {};  // channels of its variables, from their first value on
  std::optional<std::uint16_t> cost = {};                    // from the first call on
};

struct BodyChannels {
  /// A link whose pose isn't determined by joints.
  struct FreeLink {
    int link = 0;
    std::uint16_t pose = 0, twist = 0;
  };

  std::optional<std::uint16_t> joints, measured_joints;
  std::vector<FreeLink> free_links;
  std::optional<std::uint16_t> actuators;
  std::vector<int> actuated;  // ids of the joints with an actuator
  FixedMessage joint_message, actuator_message, pose_message, twist_message;
  std::vector<DeviceRecorder> devices;
};

struct Recorder::Impl : TraceOutput {
  const Scenario& scenario;
  SupervisedWriter* supervised = nullptr;  // the Writer, if a supervisor writes the recording
  std::vector<BodyChannels> bodies;
  std::vector<ControllerChannels> controllers;
  mcap::StringMap devices_read;  // labels of the controllers that read a device, by BODY/DEVICE
  std::optional<ContactRecorder> contact_recorder;
  std::uint16_t tick_channel = 0, transform_channel = 0, checkpoint_channel = 0, event_channel = 0;
  std::optional<std::uint16_t> joystick_channel;
  std::set<int> measured_bodies;        // bodies whose joint readings differ from the truth
  std::int64_t transform_interval = 1;  // [ticks]
  bool inputs_are_written = false;      // of the present tick
  msg::Tick tick_message;
  msg::TFMessage transforms;
  msg::Joy joystick_message;

  explicit Impl(const Scenario& of) : TraceOutput(of.time_step), scenario(of) {}

  Result<void> attach_sources();
  void declare_body(const ScenarioBody& body);
  void declare_controllers(const ControllerHost& host);
  Result<void> write_joints(std::int64_t tick, BodyChannels& channels, std::uint16_t channel,
                            const std::vector<JointReading>& joints);
  Result<void> write_actuators(std::int64_t tick, BodyChannels& channels,
                               const std::vector<ActuatorReading>& actuators);
  Result<void> write_body(std::int64_t tick, std::size_t index, const BodyObservation& seen,
                          const std::vector<JointReading>& read);
  Result<void> write_transforms(std::int64_t tick, const Observation& seen);
  Result<void> write_joystick(std::int64_t tick, const JoystickReading& reading);
  Result<void> write_inputs(std::int64_t tick, const HostedController& hosted, ControllerChannels& channels);
  Result<void> close_tick(std::int64_t tick, const TickHashes& hashes);
  Result<void> write_delay(std::int64_t tick, const HostedController& hosted, ControllerChannels& channels);
  Result<void> write_variables(std::int64_t tick, const HostedController& hosted,
                               std::vector<std::optional<std::uint16_t>>& channels);
  Result<void> write_cost(std::int64_t tick, const HostedController& hosted, std::optional<std::uint16_t>& channel);
};

}  // namespace rehearse
