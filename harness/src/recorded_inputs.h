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

#include "io_layout.h"
#include "joint_arrays.h"

namespace rehearse {

class RecordedInputs {
 public:
  /// Finds the channels of `reader` that hold something of the scenario's bodies. Both must outlive this.
  RecordedInputs(const Scenario& scenario, const mcap::Reader& reader);
  ~RecordedInputs();

  /// The channels that accept() wants to see.
  const std::vector<std::uint16_t>& channels() const { return channels_; }
  /// Whether the trace holds a quantity of a link, or what a device measured.
  bool has(int body, const IoField& field) const;
  bool has_device(int body, int device) const;

  /// A new tick begins: nothing is fresh.
  void begin_tick();
  /// Takes a message into the observation. An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);
  const Observation& observation() const { return observation_; }

 private:
  struct Feed;
  void add_joints(int body, const mcap::Channel& channel);
  void add_link(int body, const std::string& link, const std::string& kind, const mcap::Channel& channel);
  void add_device(int body, int device, const std::string& kind, const mcap::Channel& channel);
  Feed& add(const mcap::Channel& channel);
  Result<void> accept_device(const Feed& feed, const mcap::Message& message);

  const Scenario& scenario_;
  Observation observation_;
  std::vector<std::uint16_t> channels_;
  std::map<std::uint16_t, std::unique_ptr<Feed>> feeds_;
};

}  // namespace rehearse
