// ReplayedPart: the part of a branch that was recorded already. The source's states, sensors and frames are copied as
// they are, and what the controllers do on its inputs is recorded anew.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "altered_inputs.h"
#include "host/controller_host.h"
#include "recorded_inputs.h"
#include "recording/recorder.h"

namespace rehearse {

class ReplayedPart {
 public:
  /// The host has been initialised and started, the recorder has its channels. All must outlive this.
  ReplayedPart(const Scenario& scenario, mcap::Reader& source, ControllerHost& host, Recorder& recorder,
               AlteredInputs& altered);

  /// What the source's controllers commanded is kept as well, on topics with `acted`: see BranchOrigin::acted_until.
  /// `source_until`: that of the source itself.
  void keep_acted(std::optional<std::int64_t> until, std::optional<std::int64_t> source_until);

  /// All ticks before `end`, or all there are. Fails if the source can't be read up to there; a controller's failure is
  /// the host's to tell.
  Result<void> run(std::optional<std::int64_t> end);
  std::int64_t ticks() const { return ticks_; }
  /// The message that ends a complete recording: the state after its last tick.
  const std::optional<msg::Tick>& last_state() const { return last_state_; }

 private:
  enum class Part { state, controller, tick, events };
  Part part_of(const mcap::Channel& channel) const;
  bool is_altered(const std::string& topic) const;
  Result<void> take(const mcap::Message& message);
  Result<void> take_output(const mcap::Message& message, const mcap::Schema& schema, std::int64_t tick);
  Result<void> record_altered(std::int64_t tick, const Observation& seen);
  Result<bool> close_tick();

  const Scenario& scenario_;
  mcap::Reader& source_;
  ControllerHost& host_;
  Recorder& recorder_;
  AlteredInputs& altered_;
  RecordedInputs inputs_;
  std::vector<bool> is_input_, is_copied_;  // by channel id
  std::vector<Part> parts_;                 // by channel id
  std::optional<std::int64_t> acted_until_, source_acted_until_;
  Command unheard_;  // what the controllers command here moves nothing
  Observation altered_seen_;
  std::optional<msg::Tick> tick_;
  std::uint64_t now_ = 0;  // [ns]
  std::int64_t ticks_ = 0;
  std::optional<msg::Tick> last_state_;
};

}  // namespace rehearse
