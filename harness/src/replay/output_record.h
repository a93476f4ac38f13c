// OutputRecord: all that the controllers of a run gave in one tick, as a row of 64-bit words whose layout is known. Two
// rows are compared as bytes; the layout says what a word is.
#pragma once

#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/controller_host.h"

namespace rehearse {

/// The place of a field in a recording, without tick and time.
Divergence place_of(const OutputField& field);
/// The difference of two words of a field; none if their bits are equal. Tick and time are the caller's to fill in.
std::optional<Divergence> difference(const OutputField& field, std::uint64_t expected, std::uint64_t actual);

class OutputRecord {
 public:
  /// The controllers have started. Both must outlive this.
  OutputRecord(const ControllerHost& host, const Scenario& scenario);

  const std::vector<OutputField>& fields() const { return fields_; }
  /// What was given in the tick that the host has just finished, one word for each field.
  const std::vector<std::uint64_t>& row();

 private:
  void add(const HostedController& hosted, std::string channel, std::string element, std::string unit, CellKind kind);
  void add_outputs(const HostedController& hosted, const Model& model);
  void add_devices(const HostedController& hosted, const Model& model);

  /// Where the devices of a controller's body stand in the row.
  struct DevicePlace {
    std::size_t begin = 0;  // of the word that says whether it was told anything; its values follow
    std::size_t values = 0;
  };

  const ControllerHost& host_;
  std::vector<OutputField> fields_;
  std::vector<bool> has_outputs_;                  // by controller: it started
  std::vector<std::vector<DevicePlace>> devices_;  // by controller, then by device
  std::vector<std::uint64_t> row_;
};

}  // namespace rehearse
