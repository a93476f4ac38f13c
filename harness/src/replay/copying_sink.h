// CopyingSink: a recording that begins as another one, or repeats it. The source's states, sensors and frames are
// copied as they are, and what the controllers do on its inputs is recorded anew.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "altered_inputs.h"
#include "recording_source.h"
#include "run/recording_sink.h"

namespace rehearse {

class CopyingSink final : public RecordingSink {
 public:
  /// The host has been initialised and started, the recorder has its channels. `remarks` as in RecordingSink. All must
  /// outlive this.
  CopyingSink(const Scenario& scenario, mcap::Reader& source, const ControllerHost& host, Recorder& recorder,
              const AlteredInputs& altered, Diagnostics* remarks = nullptr);

  /// What the source's controllers commanded is kept as well, on topics with `acted`: see BranchOrigin::acted_until.
  /// `source_until`: that of the source itself.
  void keep_acted(std::optional<std::int64_t> until, std::optional<std::int64_t> source_until);

  /// Lets the run, whose sink this is, make all ticks before `end`, or all there are. Fails if the source can't be read
  /// up to there; a controller's failure is the host's to tell.
  Result<void> copy(RecordingSource& from, Run& run, std::optional<std::int64_t> end);

  Result<void> emit(const Moment& now) override;
  /// True if the controllers' outputs were the recorded ones in all ticks of copy(), by their hashes.
  bool same_outputs() const { return same_outputs_; }

 private:
  enum class Part { state, controller, tick, events };
  Part part_of(const mcap::Channel& channel) const;
  bool is_altered(const std::string& topic) const;
  Result<void> take(const mcap::Message& message);
  Result<void> take_output(const mcap::Message& message, const mcap::Schema& schema);
  Result<void> record_altered(const Moment& now);

  const Scenario& scenario_;
  mcap::Reader& source_;
  const ControllerHost& host_;
  const AlteredInputs& altered_;
  std::vector<bool> is_copied_;  // by channel id
  std::vector<Part> parts_;      // by channel id
  std::optional<std::int64_t> acted_until_, source_acted_until_;
  const RecordingSource* from_ = nullptr;  // of copy()
  bool same_outputs_ = true;
};

}  // namespace rehearse
