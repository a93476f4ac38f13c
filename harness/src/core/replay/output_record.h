// OutputRecord: all outputs of a run's controllers in one tick, as a row of 64-bit words with a fixed layout. Two rows
// are compared as bytes; the layout states the meaning of each word.
#pragma once

#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/host/controller_host.h"

namespace rehearse {

/// The place of a field in a recording, without tick and time.
Divergence place_of(const OutputField& field);
/// The difference of two words of a field; nullopt if their bits are equal. The caller fills in tick and time.
std::optional<Divergence> difference(const OutputField& field, std::uint64_t expected, std::uint64_t actual);

class OutputRecord {
 public:
  /// The controllers must have started. Both references must outlive this.
  OutputRecord(const ControllerHost& host, const Scenario& scenario);

  const std::vector<OutputField>& fields() const { return fields_; }
  /// The outputs of the tick that the host has just finished, one word for each field.
  const std::vector<std::uint64_t>& row();

 private:
  void add(const HostedController& hosted, std::string channel, std::string element, std::string unit, CellKind kind);
  void add_outputs(const HostedController& hosted, const Model& model);
  void add_devices(const HostedController& hosted, const Model& model);

  /// The words of one device in the row.
  struct DevicePlace {
    std::size_t begin = 0;   // index of the word that is 1 if the device was commanded; its values follow
    std::size_t values = 0;  // number of values
  };

  const ControllerHost& host_;
  std::vector<OutputField> fields_;
  std::vector<bool> has_outputs_;                  // by controller: true if it started
  std::vector<std::vector<DevicePlace>> devices_;  // by controller, then by device
  std::vector<std::uint64_t> row_;
};

}  // namespace rehearse
