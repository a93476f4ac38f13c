#include "recorded_checkpoints.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/clock.h"
#include "checkpoint_trial.h"
#include "core/recording/recorder.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "plant.h"
#include "sensor_errors.h"

namespace rehearse {

RecordedCheckpoints::RecordedCheckpoints(const Trace& recording, const Scenario& scenario, std::int64_t from,
                                         std::int64_t to)
    : recording_(recording), scenario_(scenario), channel_(recording.find_channel(run_topics::checkpoint)) {
  if (!channel_ || !is_without_messages(recording)) return;
  const auto at = static_cast<std::size_t>(channel_ - recording.channels().data());
  const std::uint64_t begin = nanoseconds_of(from, scenario.time_step);
  messages_ = std::make_unique<TraceWindows>(recording, std::vector{at}, WindowsStart{begin});
  messages_->move(begin,
                  to == no_end ? std::numeric_limits<std::uint64_t>::max() : nanoseconds_of(to, scenario.time_step));
  channel_ = &messages_->window().channels()[at];
}

Result<msg::Checkpoint> RecordedCheckpoints::read(std::size_t row) const {
  const auto payload = REHEARSE_TRY((messages_ ? messages_->window() : recording_).payload(*channel_, row));
  CdrReader reader(payload);
  msg::Checkpoint checkpoint;
  if (msg::decode(reader, checkpoint)) return checkpoint;
  return error_in(recording_.file(),
                  fmt::format("a message on /checkpoint at {} ns is not of its type", channel_->times[row]));
}

Result<std::string> RecordedCheckpoints::objection() const {
  if (!channel_ || channel_->messages() == 0) return std::string("the recording has no checkpoints");
  const auto outcome = RunFacts::of(recording_).outcome;
  if (outcome && outcome->checkpoints.value_or(CheckpointTrial::exact) != CheckpointTrial::exact)
    return fmt::format("the recording says that its checkpoints are {}", *outcome->checkpoints);
  const auto first = REHEARSE_TRY(read(0));
  if (first.format != checkpoint_format)
    return fmt::format("its checkpoints are in the form '{}', and this version restores '{}'", first.format,
                       checkpoint_format);
  return std::string();
}

/// Compares the files that determine the parts of a state and their order.
bool RecordedCheckpoints::has_its_own_scenario() const {
  const auto is_attached = [&](const std::string& name, const std::string& text) {
    const mcap::Attachment* attachment = recording_.find_attachment(name);
    return attachment && std::ranges::equal(std::as_bytes(std::span(text)), attachment->data);
  };
  return is_attached("scenario.yaml", scenario_.text) && std::ranges::all_of(scenario_.bodies, [&](const auto& body) {
           return body.model_file.empty() || is_attached(body.model_file, body.model->source_text);
         });
}

Result<void> RecordedCheckpoints::make_recorded_world() {
  const auto recorded = REHEARSE_TRY(recorded_scenario(recording_));
  readings_size_ = SensorErrors(recorded).save().size();
  std::vector<WorldBody> bodies = world_bodies(recorded);
  for (WorldBody& body : bodies) {  // a recording contains no meshes, and a state no shapes
    Model model = *body.model;
    for (Link& link : model.links) link.collisions.clear();
    body.model = std::make_shared<const Model>(std::move(model));
  }
  recorded_world_ = REHEARSE_TRY(World::create(recorded, std::move(bodies)));
  return {};
}

Result<bool> RecordedCheckpoints::restore(std::int64_t tick, World& world, std::vector<std::byte>* readings) {
  if (!channel_) return false;
  const std::uint64_t time = nanoseconds_of(tick, scenario_.time_step);
  const auto found = std::ranges::lower_bound(channel_->times, time);
  if (found == channel_->times.end() || *found != time) return false;
  const auto checkpoint = REHEARSE_TRY(read(static_cast<std::size_t>(found - channel_->times.begin())));
  if (!std::exchange(prepared_, true)) {
    if (has_its_own_scenario())
      readings_size_ = SensorErrors(scenario_).save().size();
    else if (auto made = make_recorded_world(); !made)
      return made.errors();
  }
  const auto whole = std::as_bytes(std::span(checkpoint.data));
  const auto state = whole.first(whole.size() - std::min(whole.size(), readings_size_));
  const auto rest = whole.subspan(state.size());
  if (readings && !recorded_world_) readings->assign(rest.begin(), rest.end());
  auto restored = recorded_world_ ? recorded_world_->restore(state) : world.restore(state);
  if (restored && recorded_world_) restored = world.take_state(*recorded_world_);
  if (!restored) {
    Diagnostic finding = restored.errors()[0];
    finding.message = fmt::format("the checkpoint of tick {} doesn't fit: {}", tick, finding.message);
    finding.file = recording_.file();
    return finding;
  }
  if (world.tick() == tick) return true;
  return error(fmt::format("the checkpoint of tick {} contains the state of tick {}", tick, world.tick()));
}

std::vector<std::int64_t> RecordedCheckpoints::ticks() const {
  std::vector<std::int64_t> ticks;
  if (!channel_) return ticks;
  for (const std::uint64_t time : channel_->times)
    ticks.push_back(std::llround(static_cast<double>(time) * 1e-9 / scenario_.time_step));
  return ticks;
}

}  // namespace rehearse
