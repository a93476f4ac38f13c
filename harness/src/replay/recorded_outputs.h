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
  /// Finds the output channels of the controllers, which must have started. `fields`: the fields of the rows. All
  /// references must outlive this.
  RecordedOutputs(const ControllerHost& host, const std::vector<OutputField>& fields, const mcap::Reader& trace);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  void begin_tick();
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Calls `differs` for each number whose bits differ in the row of the tick: recorded numbers by channel, then
  /// numbers that only the row has, then results of control(). The caller fills in tick and time. Returns the number of
  /// compared recorded values. `results`: the recorded results of control(), by controller.
  std::int64_t compare(const std::vector<std::uint64_t>& row, const std::vector<bool>& results,
                       const OnDifference& differs);

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  /// A recorded number and its word in the row.
  struct Pair {
    const double* expected;  // address to which accept() writes it
    std::size_t word;        // its index; none: no controller commands the number now
    std::string element;
  };
  struct Channel {
    std::string topic;
    ChannelKind kind = ChannelKind::other;
    mcap::StringMap metadata;
    const HostedController* hosted = nullptr;
    std::size_t told = none;  // the word that is 1 if the device was commanded; none: the channel isn't a device's
    bool here = false;        // the channel had a message in this tick
    bool was_here = false;    // the channel had a message in the tick of unpaired_
    JointArrays joints;
    std::vector<std::string> names;  // joints of a channel of accelerations
    std::vector<double> values;      // values of a channel of any kind but joints
    std::vector<Pair> pairs;
  };
  /// A word of the row, and its controller.
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
  std::map<std::pair<std::string, std::string>, std::size_t> words_;  // index of the word by channel and element
  std::vector<std::uint16_t> channels_;
  std::map<std::uint16_t, Channel> by_id_;
  std::vector<Word> commands_;  // words of numbers, except those of devices
  std::vector<Word> untold_;    // words that are 1 if a device was commanded, of devices without recorded commands
  std::vector<std::size_t> result_words_;  // word of the result of control(), by controller
  bool new_pairs_ = true;                  // pairs were added since unpaired_ was made
  std::vector<Word> unpaired_;             // words of commands_ that no message of the tick contains
};

}  // namespace rehearse
