// SideRecorder: records the inputs or the outputs of one controller as messages of a trace.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/host/io_layout.h"
#include "trace_output.h"

namespace rehearse {

/// Units of the elements of a message of joints, by their ids. No element has a `wrap:` entry, because angles count
/// turns.
mcap::StringMap joint_metadata(ChannelKind kind, const Model& model, const std::vector<int>& joints);

class SideRecorder {
 public:
  /// Adds the channels of one side of the controller `label`. `metadata`: metadata of each channel, in addition to
  /// units.
  SideRecorder(TraceOutput& output, const std::string& label, ChannelSide side, const Model& model,
               const IoLayout& layout, mcap::StringMap metadata = {});
  /// Records the numbers of a tick, in the order of the layout.
  Result<void> write(TraceOutput& output, std::int64_t tick, const std::vector<double>& values);

  const mcap::StringMap& metadata() const { return metadata_; }

 private:
  struct LinkChannel {
    std::uint16_t channel;
    IoField field;
    FixedMessage message;
  };
  void add_joints(TraceOutput& output, const ChannelName& of_side, const Model& model, const IoLayout& layout);
  void add_link(TraceOutput& output, ChannelName name, const Model& model, const IoField& field);
  Result<void> write_joints(TraceOutput& output, std::int64_t tick, const std::vector<double>& values);

  mcap::StringMap metadata_;
  std::optional<std::uint16_t> joints_, accelerations_;  // channels
  FixedMessage joint_message_, acceleration_message_;
  std::vector<int> joint_offsets_, acceleration_offsets_;  // by number of the message: its offset in the layout
  std::vector<LinkChannel> links_;
};

}  // namespace rehearse
