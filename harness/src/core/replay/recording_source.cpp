#include "recording_source.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>

#include <utility>

#include "base/clock.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

Diagnostic in_recording(const mcap::Reader& recording, Diagnostic finding) {
  if (finding.file.empty()) finding.file = recording.name();
  return finding;
}

RecordingSource::RecordingSource(const Scenario& scenario, mcap::Reader& recording, const ControllerHost& host,
                                 AlteredInputs& altered)
    : scenario_(scenario),
      recording_(recording),
      host_(host),
      altered_(altered),
      inputs_(scenario, recording),
      channels_(inputs_.channels_read_by(host, !altered.empty())) {
  const auto& all = recording.channels();
  for (const auto& [id, channel] : all)
    if (channel.topic == run_topics::tick) tick_channel_ = id;
  if (has_ticks()) channels_.push_back(tick_channel_);
  is_observed_.assign(all.empty() ? 0 : std::size_t{all.rbegin()->first} + 1, false);
  for (const std::uint16_t id : channels_) is_observed_[id] = true;
}

Result<void> RecordingSource::drive(Run& run, const Take& take, std::span<const std::uint16_t> channels,
                                    std::uint64_t before) {
  Result<void> failed;
  bool going_on = true;
  const auto finish_tick = [&] {
    if (!std::exchange(tick_here_, false)) return true;  // before the first tick, or a tick that wasn't closed
    const auto stepped = run.step();
    if (!stepped) failed = stepped.errors();
    return stepped && *stepped;
  };
  const auto gather = [&](const mcap::Message& message) {
    if (message.log_time != time_ && !(going_on = finish_tick())) return false;
    time_ = message.log_time;
    if (time_ >= before) return going_on = false;
    auto taken = is_observed_[message.channel->id] ? accept(message) : Result<void>();
    if (taken) taken = take(message);
    if (!taken) failed = std::move(taken);
    return going_on = failed.ok();
  };
  damage_ = recording_.for_each_message_in_order(gather, channels).errors();
  if (going_on) finish_tick();
  return failed;
}

Result<void> RecordingSource::accept(const mcap::Message& message) {
  if (message.channel->id != tick_channel_) {
    auto accepted = inputs_.accept(message);
    return accepted ? accepted : in_recording(recording_, accepted.errors()[0]);
  }
  CdrReader reader(message.data);
  if ((tick_here_ = msg::decode(reader, tick_))) return {};
  return in_recording(recording_,
                      error(fmt::format("a message on /tick at {} ns is not of its type", message.log_time)));
}

Result<bool> RecordingSource::observe(TickData& now) {
  const bool is_last_state = tick_.controller_results.size() != host_.controllers().size();
  if (is_last_state) {  // after the last step only the state is recorded
    last_state_ = tick_;
    return false;
  }
  if (time_ >= until_) {
    cut_short_ = true;
    return false;
  }
  if (tick_.tick != now.tick) return gap(now.tick);
  now.seen = now.read = &inputs_.observation();
  now.state_hash = tick_.state_hash;
  if (altered_.empty()) return true;
  altered_observation_ = inputs_.observation();
  altered_.apply(now.tick, altered_observation_);
  now.seen = now.read = &altered_observation_;
  return true;
}

/// The error for a missing tick: the recording was cut or damaged. All ticks before determine a controller's
/// state, so none of them may be missing.
Diagnostic RecordingSource::gap(std::int64_t expected) const {
  return in_recording(
      recording_,
      expected == 0
          ? error(fmt::format(
                      "its first tick is {}: the ticks before are missing, and controllers can't begin in the middle",
                      tick_.tick),
                  "replay the whole recording, with --from")
          : error(
                fmt::format(
                    "tick {} follows tick {}: the ticks between are missing, and controllers can't go on without them",
                    tick_.tick, expected - 1),
                fmt::format("replay it up to there: --until {:g}", time_of(expected, scenario_.time_step))));
}

/// The recording contains the next state of the world: nothing is simulated.
Result<bool> RecordingSource::advance(TickData& now, Commander& commands) {
  commands.act_late(now);
  inputs_.begin_tick();
  return true;
}

}  // namespace rehearse
