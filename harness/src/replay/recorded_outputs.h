// RecordedOutputs: what one controller commanded in a recording, tick by tick, to be compared with what it commands
// now.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host/controller_host.h"
#include "joint_arrays.h"
#include "trace/channel_name.h"

namespace rehearse {

class RecordedOutputs {
 public:
  /// Finds the controller's output channels in the trace; it has been initialised. All must outlive this.
  RecordedOutputs(const HostedController& hosted, const Scenario& scenario, const mcap::Reader& trace);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  void begin_tick();
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Calls `differs` for each number that isn't the same bits now: joints, then links, then devices. Tick and time are
  /// the caller's to fill in. Returns how many numbers were compared.
  std::int64_t compare(const OnDifference& differs);
  /// Calls `differs` if the commands act a tick later, or earlier, than the recorded ones did.
  void compare_delay(bool delayed, const OnDifference& differs) const;

 private:
  /// A recorded number and the place in output_values() that it must equal.
  struct Pair {
    const double* expected;  // where accept() puts it
    int place;               // -1: the controller doesn't command it now
    std::string element;
  };
  struct Channel {
    std::string topic;
    ChannelKind kind = ChannelKind::other;
    mcap::StringMap metadata;
    int device = -1;
    bool here = false;      // had a message in this tick
    bool was_here = false;  // in the tick of unpaired_
    JointArrays joints;
    std::vector<double> values;  // of a link or a device
    std::vector<Pair> pairs;
  };

  void pair_joints(Channel& channel);
  void find_unpaired();
  void pair_link(Channel& channel, int link);
  int place_of(int link, Quantity quantity) const;
  std::int64_t compare_device(const Channel& channel, const OnDifference& differs) const;
  Divergence divergence(const std::string& topic, const std::string& element) const;

  const HostedController& hosted_;
  const Model& model_;
  std::vector<std::uint16_t> channels_;
  std::map<std::uint16_t, Channel> by_id_;
  bool new_pairs_ = true;      // since unpaired_ was made
  std::vector<int> unpaired_;  // links with a commanded field that no message of the tick contains
};

}  // namespace rehearse
