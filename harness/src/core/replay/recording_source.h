// RecordingSource: reads the observations of a run from a recording, tick by tick.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "altered_inputs.h"
#include "core/run/run.h"
#include "recorded_inputs.h"

namespace rehearse {

class RecordingSource final : public ObservationSource {
 public:
  using Take = std::function<Result<void>(const mcap::Message&)>;
  static constexpr std::uint64_t no_end = std::numeric_limits<std::uint64_t>::max();

  /// The host's controllers must be initialised: only the values that they read are taken. The alterations of `altered`
  /// are made before the controllers read. All references must outlive this.
  RecordingSource(const Scenario& scenario, mcap::Reader& recording, const ControllerHost& host,
                  AlteredInputs& altered);

  const RecordedInputs& inputs() const { return inputs_; }
  bool alters() const { return !altered_.empty(); }
  /// The channels of the observations and of the ticks; without ticks nothing can be observed.
  const std::vector<std::uint16_t>& channels() const { return channels_; }
  bool has_ticks() const { return tick_channel_ != 0; }
  /// The run ends before the first tick at this time or later [ns].
  void end_before(std::uint64_t until) { until_ = until; }

  /// Reads the messages of `channels` (all if empty) before `before` [ns] in order, hands each to `take` and lets the
  /// run make a step for each tick whose messages have all been read. Fails if the run does, or if a message isn't of
  /// its type. damage() returns the damage that the reader finds: the run is made up to there.
  Result<void> drive(Run& run, const Take& take, std::span<const std::uint16_t> channels = {},
                     std::uint64_t before = no_end);
  const Diagnostics& damage() const { return damage_; }

  Result<bool> observe(TickData& now) override;
  Result<bool> advance(TickData& now, Commander& commands) override;

  /// The recorded data of the tick that was observed last.
  const msg::Tick& recorded() const { return tick_; }
  /// The message that ends a complete recording: the state after its last tick.
  const std::optional<msg::Tick>& last_state() const { return last_state_; }
  /// The run ended by end_before(); the recording goes on.
  bool was_cut_short() const { return cut_short_; }

 private:
  Result<void> accept(const mcap::Message& message);
  Diagnostic gap(std::int64_t expected) const;

  const Scenario& scenario_;
  mcap::Reader& recording_;
  const ControllerHost& host_;
  AlteredInputs& altered_;
  RecordedInputs inputs_;
  std::vector<std::uint16_t> channels_;
  std::vector<bool> is_observed_;  // by channel id
  std::uint16_t tick_channel_ = 0;
  std::uint64_t until_ = no_end;  // [ns]
  std::uint64_t time_ = 0;        // log time of the messages that are being read [ns]
  msg::Tick tick_;
  bool tick_here_ = false;  // /tick had a message at time_
  bool cut_short_ = false;
  std::optional<msg::Tick> last_state_;
  Observation altered_observation_;
  Diagnostics damage_;
};

/// Names the recording as the file of a finding that names no file.
Diagnostic in_recording(const mcap::Reader& recording, Diagnostic finding);

}  // namespace rehearse
