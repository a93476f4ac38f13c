// The doctor's checks of the messages of a file: schemas that can't be parsed, payloads that don't fit their schema,
// and in recordings of Rehearse their required parts (harness/TRACE_FORMAT.md).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/mcap/examination.h"
#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// Passed to mcap::examine() as ExamineOptions::content; for one file.
class TraceCheck : public mcap::ContentCheck {
 public:
  void schema(const mcap::Schema& schema, mcap::Place place, mcap::Findings& findings) override;
  void message(const mcap::Message& message, const mcap::Schema* schema, mcap::Place place,
               mcap::Findings& findings) override;
  void attachment(const mcap::Attachment& attachment, mcap::Findings& findings) override;
  void metadata(const mcap::Metadata& metadata, mcap::Findings& findings) override;
  void end(std::uint64_t size, mcap::Findings& findings) override;

 private:
  struct ChannelState {
    std::unique_ptr<ros2msg::Decoder> decoder;  // null: the payloads aren't examined
    bool is_tick = false;
    std::uint64_t broken = 0;  // number of payloads that can't be decoded
    mcap::Place broken_at;     // place of the first of these payloads
    std::string topic, type;
  };

  ChannelState& state_of(const mcap::Message& message, const mcap::Schema* schema);
  void tick(const mcap::Message& message, mcap::Place place);
  void examine_recording(mcap::Findings& findings) const;
  void examine_outcome(mcap::Findings& findings) const;

  std::map<std::uint16_t, ChannelState> channels_;  // by id
  std::vector<std::string> attachments_;            // names of attachments
  std::map<std::string, mcap::Metadata> metadata_;  // the last record of each name
  int provenances_ = 0;

  std::int64_t ticks_ = 0;  // number of messages on /tick
  std::int64_t first_tick_ = 0, last_tick_ = 0;
  std::uint64_t gaps_ = 0;
  mcap::Place gap_at_;  // place of the first gap
  std::int64_t gap_after_ = 0, gap_before_ = 0;
};

}  // namespace rehearse
