#include "recorded_checkpoints.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/clock.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>

#include "checkpoint_trial.h"
#include "recording/recorder.h"

namespace rehearse {

Result<msg::Checkpoint> RecordedCheckpoints::read(std::size_t row) const {
  const auto payload = recording_.payload(*channel_, row);
  if (!payload) return payload.errors();
  CdrReader reader(*payload);
  msg::Checkpoint checkpoint;
  if (msg::decode(reader, checkpoint)) return checkpoint;
  Diagnostic finding = error(fmt::format("a message on /checkpoint at {} ns is not of its type", channel_->times[row]));
  finding.file = recording_.file();
  return finding;
}

Result<std::string> RecordedCheckpoints::objection() const {
  if (!channel_ || channel_->messages() == 0) return std::string("the recording has no checkpoints");
  const mcap::StringMap* outcome = recording_.find_metadata("rehearse.outcome");
  const auto stated = outcome ? outcome->find("checkpoints") : mcap::StringMap::const_iterator();
  if (outcome && stated != outcome->end() && stated->second != CheckpointTrial::exact)
    return fmt::format("the recording says that its checkpoints are {}", stated->second);
  const auto first = read(0);
  if (!first) return first.errors();
  if (first->format != checkpoint_format)
    return fmt::format("its checkpoints are in the form '{}', and this version restores '{}'", first->format,
                       checkpoint_format);
  return std::string();
}

Result<std::optional<std::vector<std::byte>>> RecordedCheckpoints::at(std::int64_t tick) const {
  using State = std::optional<std::vector<std::byte>>;
  if (!channel_) return State();
  const std::uint64_t time = nanoseconds_of(tick, time_step_);
  const auto found = std::lower_bound(channel_->times.begin(), channel_->times.end(), time);
  if (found == channel_->times.end() || *found != time) return State();
  const auto checkpoint = read(static_cast<std::size_t>(found - channel_->times.begin()));
  if (!checkpoint) return checkpoint.errors();
  const auto* data = reinterpret_cast<const std::byte*>(checkpoint->data.data());
  return State(std::in_place, data, data + checkpoint->data.size());
}

std::vector<std::int64_t> RecordedCheckpoints::ticks() const {
  std::vector<std::int64_t> ticks;
  if (!channel_) return ticks;
  for (const std::uint64_t time : channel_->times)
    ticks.push_back(std::llround(static_cast<double>(time) * 1e-9 / time_step_));
  return ticks;
}

}  // namespace rehearse
