// ContactRecorder: records contacts as messages of a trace: begin and end of contacts between links, and the contacts
// that controllers read.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <string>
#include <vector>

#include "trace_output.h"

namespace rehearse {

class ContactRecorder {
 public:
  /// Adds the channel.
  ContactRecorder(TraceOutput& output, const Scenario& scenario);
  /// Records the changes since the last call; before the first call there are no contacts. `touching` is ascending.
  Result<void> write(TraceOutput& output, std::int64_t tick, const std::vector<LinkPair>& touching);
  /// Records the contacts that a controller reads: a message for each of its links. `channels`: by link.
  Result<void> write_input(TraceOutput& output, std::int64_t tick, const std::vector<std::uint16_t>& channels,
                           const std::vector<std::vector<ContactReading>>& contacts);
  /// Sets the existing contacts of a run that begins in the middle; they are not recorded.
  void begin_with(const std::vector<LinkPair>& touching) { touching_ = touching; }

 private:
  Result<void> write_change(TraceOutput& output, std::int64_t tick, const LinkPair& pair, bool begins);

  std::uint16_t channel_;
  std::vector<std::vector<std::string>> names_;  // by body and link: "Body/LINK"
  std::vector<LinkPair> touching_;
  msg::Contacts input_message_;
};

}  // namespace rehearse
