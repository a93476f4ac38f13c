// RecordedOutputs: the commands of the controllers in a recording, tick by tick. They are compared with the row of an
// OutputRecord.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/controller_host.h"
#include "joint_arrays.h"
#include "trace/channel_name.h"

namespace rehearse {

class RecordedOutputs {
 public:
  /// Finds the output channels of the controllers, which have started. `fields`: of the rows. All must outlive this.
  RecordedOutputs(const ControllerHost& host, const std::vector<OutputField>& fields, const mcap::Reader& trace);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  void begin_tick();
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Calls `differs` for each number whose bits differ in the row of the tick: recorded ones by channel, then those
  /// that only the row has, then results of control(). Tick and time are the caller's to fill in. Returns how many
  /// recorded values were compared. `results`: the recorded ones of control(), by controller.
  std::int64_t compare(const std::vector<std::uint64_t>& row, const std::vector<bool>& results,
                       const OnDifference& differs);
  /// Calls `differs` for each controller whose commands act a tick later, or earlier, than the recorded ones.
  void compare_delays(const OnDifference& differs) const;

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  /// A recorded number and its word in the row.
  struct Pair {
    const double* expected;  // where accept() puts it
    std::size_t word;        // none: no controller commands it now
    std::string element;
  };
  struct Channel {
    std::string topic;
    ChannelKind kind = ChannelKind::other;
    mcap::StringMap metadata;
    const HostedController* hosted = nullptr;
    std::size_t told = none;  // the word that is 1 if the device was commanded; none: the channel is no device's
    bool here = false;        // had a message in this tick
    bool was_here = false;    // in the tick of unpaired_
    JointArrays joints;
    std::vector<std::string> names;  // of joint accelerations
    std::vector<double> values;      // of all kinds but joints
    std::vector<Pair> pairs;
  };
  /// A word of the row, and the controller that it belongs to.
  struct Word {
    std::size_t word;
    const HostedController* hosted;
  };

  void add_channel(const mcap::Channel& channel, const ChannelName& name, const HostedController& hosted);
  void sort_words();
  std::size_t word_of(const std::string& channel, const std::string& element) const;
  bool read(Channel& channel, mcap::Bytes payload);
  void pair_joints(Channel& channel);
  void pair_values(Channel& channel);
  void add_pair(Channel& channel, const double& expected, std::string element, bool may_lack_field);
  void find_unpaired();
  std::int64_t compare_channel(const Channel& channel, const std::vector<std::uint64_t>& row,
                               const OnDifference& differs) const;
  Divergence lone(const Channel& channel, const Pair& pair) const;

  const ControllerHost& host_;
  const std::vector<OutputField>& fields_;
  std::map<std::pair<std::string, std::string>, std::size_t> words_;  // by channel and element
  std::vector<std::uint16_t> channels_;
  std::map<std::uint16_t, Channel> by_id_;
  std::vector<Word> commands_;             // words of numbers, except those of devices
  std::vector<Word> untold_;               // words that are 1 if a device was commanded, of devices that never were
  std::vector<std::size_t> result_words_;  // by controller
  bool new_pairs_ = true;                  // since unpaired_ was made
  std::vector<Word> unpaired_;             // of commands_: those that no message of the tick contains
};

}  // namespace rehearse
