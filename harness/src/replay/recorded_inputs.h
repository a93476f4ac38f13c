// RecordedInputs: a trace's messages turned back into the observations that the controllers saw.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/controller_host.h"
#include "host/io_layout.h"
#include "trace/channel_name.h"

namespace rehearse {

class RecordedInputs {
 public:
  /// Finds the channels of `reader` that hold something of the scenario's bodies. Both must outlive this. Where the
  /// recording keeps samples of the state, the channels of the controllers' inputs take its place.
  RecordedInputs(const Scenario& scenario, mcap::Reader& reader);
  ~RecordedInputs();

  /// The channels that hold what a controller of the host reads: accept() wants to see these, and no others.
  std::vector<std::uint16_t> channels_read_by(const ControllerHost& host) const;
  /// Whether the trace holds a quantity of a link, or what a device measured.
  bool has(int body, const IoField& field) const;
  bool has_device(int body, int device) const;
  bool has_contacts(int body, int link) const;
  bool has_joystick() const;

  /// A new tick begins: nothing is fresh.
  void begin_tick();
  /// Takes a message into the observation. An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);
  const Observation& observation() const { return observation_; }

 private:
  struct Feed;
  bool feeds(const Feed& feed, int body, const IoField& field) const;
  void add(std::uint16_t id, const ChannelName& name, const std::string& topic);
  void add_joints_read(mcap::Reader& reader, std::uint16_t id, const ChannelName& name);
  bool accept_joints(Feed& feed, mcap::Bytes payload);
  bool accept_accelerations(const Feed& feed, mcap::Bytes payload);
  Result<void> accept_joystick(const mcap::Message& message);
  Result<void> accept_device(const Feed& feed, const mcap::Message& message);

  const Scenario& scenario_;
  Observation observation_;
  std::map<std::uint16_t, std::unique_ptr<Feed>> feeds_;
};

}  // namespace rehearse
