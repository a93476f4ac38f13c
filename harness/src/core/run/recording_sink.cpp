#include "recording_sink.h"

#include <utility>

namespace rehearse {

Result<void> RecordingSink::begin_tick(const TickData& now) {
  if (!now.checkpoint.empty()) REHEARSE_TRY(recorder_.record_checkpoint(now.tick, now.checkpoint));
  REHEARSE_TRY(recorder_.record_state(now.tick, *now.seen, *now.read));
  if (now.truths) REHEARSE_TRY(recorder_.record_truths(now.tick, *now.truths));
  if (auto done = record_contacts(now); !done || !now.host) return done;
  input_hash_ = now.host->input_hash(*now.read);
  return recorder_.record_inputs(now.tick, *now.host, {now.state_hash, *input_hash_, 0});
}

Result<void> RecordingSink::record_contacts(const TickData& now) {
  if (!now.touching) return {};
  if (now.tick >= known_before_) return recorder_.record_contacts(now.tick, *now.touching);
  recorder_.begin_with_contacts(*now.touching);
  return {};
}

Result<void> RecordingSink::emit(const TickData& now) {
  TickHashes hashes{now.state_hash, 0, 0};
  const std::optional<std::uint64_t> known = std::exchange(input_hash_, std::nullopt);
  if (now.host) hashes = {now.state_hash, known ? *known : now.host->input_hash(*now.read), now.host->output_hash()};
  REHEARSE_TRY(recorder_.record_tick(now.tick, now.host, hashes));
  REHEARSE_TRY(record_events(now.events));
  return now.host ? record_events(now.host->take_events()) : Result<void>();
}

Result<void> RecordingSink::record_events(const std::vector<msg::Event>& events) {
  if (remarks_)
    for (const msg::Event& event : events)
      if (event.source != "log") append_remarks({event}, *remarks_);  // the log's events are reported per topic
  return recorder_.record_events(events);
}

}  // namespace rehearse
