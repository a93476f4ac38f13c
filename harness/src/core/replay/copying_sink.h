// CopyingSink: writes a recording that begins like another recording, or repeats it completely. The source's states,
// sensors and frames are copied unchanged; the controllers' outputs for these inputs are recorded anew.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "altered_inputs.h"
#include "core/recording/copied_recording.h"
#include "core/run/recording_sink.h"
#include "recording_source.h"

namespace rehearse {

class CopyingSink final : public RecordingSink {
 public:
  /// The host must be initialised and started, and the recorder must have its channels. `remarks` as in RecordingSink.
  /// All references must outlive this.
  CopyingSink(const Scenario& scenario, mcap::Reader& source, const ControllerHost& host, Recorder& recorder,
              const AlteredInputs& altered, Diagnostics* remarks = nullptr);

  /// Also copies the commands of the source's controllers, to topics with `acted`: see BranchOrigin::acted_until.
  /// `source_until`: the acted_until of the source itself.
  void keep_acted(std::optional<std::int64_t> until, std::optional<std::int64_t> source_until);

  /// Lets the run, whose sink this is, make all ticks before `end`; without `end`, all ticks of the source. Fails if
  /// the source can't be read up to there; the host reports a controller's failure.
  Result<void> copy(RecordingSource& from, Run& run, std::optional<std::int64_t> end);

  /// Records nothing: the observations are copied.
  Result<void> begin_tick(const TickData&) override { return {}; }
  Result<void> emit(const TickData& now) override;
  /// True if the hashes of the controllers' outputs were the recorded hashes in all ticks of copy().
  bool same_outputs() const { return same_outputs_; }

 private:
  enum class Part { state, controller, tick, events };
  Part part_of(const mcap::Channel& channel) const;
  bool is_altered(const std::string& topic) const;
  Result<void> take(const mcap::Message& message);
  Result<void> take_output(const mcap::Message& message, const mcap::Schema& schema);
  Result<void> record_altered(const TickData& now);

  const Scenario& scenario_;
  mcap::Reader& source_;
  const ControllerHost& host_;
  CopiedRecording copy_;
  const AlteredInputs& altered_;
  std::vector<bool> is_copied_;  // by channel id
  std::vector<Part> parts_;      // by channel id
  std::optional<std::int64_t> acted_until_, source_acted_until_;
  const RecordingSource* from_ = nullptr;  // argument of copy()
  bool same_outputs_ = true;
};

}  // namespace rehearse
