// RecordedInputs: converts a trace's messages back to the observations of the controllers.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/host/controller_host.h"
#include "core/host/io_layout.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

class RecordedInputs {
 public:
  /// Finds the channels of `reader` that contain data of the scenario's bodies. Both references must outlive this.
  RecordedInputs(const Scenario& scenario, mcap::Reader& reader);
  ~RecordedInputs();

  /// The channels that contain the values that the host's controllers read: accept() needs only these channels. For
  /// joints they are the controllers' inputs, and the state of the body only for values that no input has.
  /// `whole_state`: adds the state of all joints of these bodies, for an observation that is recorded.
  std::vector<std::uint16_t> channels_read_by(const ControllerHost& host, bool whole_state) const;
  // True if the trace contains the quantity of a link, the device's measurements, the link's contacts, or the joystick.
  bool has(int body, const IoField& field) const;
  bool has_device(int body, int device) const;
  bool has_contacts(int body, int link) const;
  bool has_joystick() const;
  /// The values of joints that controllers read in the recording: "KNEE/dq of SR1/Walker".
  std::set<std::string> joints_read() const;

  /// Begins a new tick: no reading of a device is fresh.
  void begin_tick();
  /// Takes a message into the observation. An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);
  const Observation& observation() const { return observation_; }

 private:
  struct Feed;
  bool feeds(const Feed& feed, int body, const IoField& field) const;
  bool has_input(int body, const IoField& field) const;
  void add(std::uint16_t id, const ChannelName& name, const std::string& topic);
  void add_joints_read(mcap::Reader& reader, std::uint16_t id, const ChannelName& name);
  bool accept_joints(Feed& feed, mcap::Bytes payload);
  Result<void> accept_joystick(const mcap::Message& message);
  Result<void> accept_device(const Feed& feed, const mcap::Message& message);

  const Scenario& scenario_;
  Observation observation_;
  std::map<std::uint16_t, std::unique_ptr<Feed>> feeds_;
};

}  // namespace rehearse
