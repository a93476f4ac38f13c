#include "branch_source.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/clock.h"
#include "core/kinds/channel_name.h"
#include "core/recording/provenance.h"
#include "core/replay/recording_source.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"

namespace rehearse {
namespace {

/// The recording without messages. Damage is tolerated, and found by a pass over what leads the world to the moment.
Result<Trace> load_without_messages(mcap::Reader& reader, const std::filesystem::path& file) {
  if (reader.can_copy_chunks()) return load_sizes(file);
  const auto is_needed = [](const mcap::Channel& channel) {
    const ChannelName name = ChannelName::parse(channel.topic);
    return channel.topic == run_topics::tick || name.kind == ChannelKind::events || name.side == ChannelSide::output ||
           name.side == ChannelSide::acted;
  };
  return load_pieces(
      file, is_needed, [](const Trace&) {}, Trace::usual_piece_size, PieceOrder::of_time, Trace::Damage::tolerate);
}

/// Loads the models with their meshes, from the scenario's files.
Result<void> take_meshes(BranchSource& source, const std::filesystem::path& scenario_file) {
  Scenario& scenario = source.scenario;
  const auto text_of = [&](const std::string& name) {
    for (const mcap::Attachment& attachment : source.reader->attachments())
      if (attachment.name == name) return std::string(attachment.text());
    return std::string();
  };
  if (scenario_file.empty()) {
    for (const ScenarioBody& body : scenario.bodies)
      if (!text_of(body.model_file + ".meshes").empty())
        return in_recording(*source.reader,
                            error(fmt::format("{} has meshes, which a recording doesn't contain", body.model_file),
                                  "name the scenario that was recorded as well: rehearse record SCENARIO "
                                  "--from-checkpoint TRACE@..."));
    return {};
  }
  auto loaded = REHEARSE_TRY(Scenario::load(scenario_file));
  const auto other = [&](const std::string& what) {
    return error_in(scenario_file.string(),
                    fmt::format("{} has changed since {} was recorded", what, source.reader->name()));
  };
  if (loaded.text != scenario.text) return other("it");
  for (const ScenarioBody& body : loaded.bodies) {
    if (body.model_file.empty()) continue;
    if (body.model->source_text != text_of(body.model_file)) return other(body.model_file);
    if (mesh_digests(*body.model) != text_of(body.model_file + ".meshes")) return other("a mesh of " + body.model_file);
  }
  loaded.seed = scenario.seed;
  loaded.duration = scenario.duration;
  loaded.pushes = scenario.pushes;
  scenario = std::move(loaded);
  return {};
}

/// Fails for a log, which has no world, and for a replay, whose world didn't follow its commands.
Result<void> check_simulated(const BranchSource& source) {
  const bool of_a_log = RunFacts::of(source.recording).is_of_log;
  if (!of_a_log && (!source.origin || source.origin->simulated)) return {};
  return in_recording(*source.reader,
                      error(of_a_log ? "it was recorded from a log, and has no world that can continue"
                                     : "it is a replay: its world didn't follow its commands, and can't continue",
                            "branch from the recording of a simulation"));
}

}  // namespace

Result<BranchSource> BranchSource::open(const std::filesystem::path& file, const std::filesystem::path& scenario_file) {
  BranchSource source;
  source.reader = REHEARSE_TRY(mcap::Reader::open(file));
  source.scenario = REHEARSE_TRY(scenario_of(*source.reader));
  REHEARSE_TRY(take_meshes(source, scenario_file));
  source.recording = REHEARSE_TRY(load_without_messages(*source.reader, file));
  source.origin = RunFacts::of(*source.reader).branch;
  REHEARSE_TRY(check_simulated(source));
  const bool has_pictures = std::ranges::any_of(source.recording.channels(), [](const TraceChannel& channel) {
    return channel.type == msg::CompressedImage::type_name;
  });
  source.scenario.record_frames = source.scenario.record_frames && has_pictures;
  const TraceChannel* ticks = source.recording.find_channel(run_topics::tick);
  source.whole_ticks = ticks ? static_cast<std::int64_t>(ticks->earlier + ticks->messages()) : 0;
  const auto outcome = RunFacts::of(source.recording).outcome;
  if (outcome && outcome->complete) --source.whole_ticks;  // the last one is the final state
  if (source.whole_ticks > 0) return source;
  return in_recording(*source.reader, error("it has no ticks: nothing of the run was recorded"));
}

std::optional<std::uint64_t> BranchSource::state_hash(std::int64_t tick) const {
  const auto& channels = reader->channels();
  const auto channel =
      std::ranges::find_if(channels, [](const auto& entry) { return entry.second.topic == run_topics::tick; });
  if (channel == channels.end()) return std::nullopt;
  const std::uint64_t time = nanoseconds_of(tick, scenario.time_step);
  mcap::OrderedMessages messages(*reader, std::span(&channel->first, 1), time);
  const mcap::Message* message = messages.next();
  msg::Tick found;
  if (!message || message->log_time != time) return std::nullopt;
  CdrReader cdr(message->data);
  return msg::decode(cdr, found) ? std::optional(found.state_hash) : std::nullopt;
}

std::int64_t BranchSource::checkpoint_interval(const RecordedCheckpoints& checkpoints) const {
  const std::vector<std::int64_t> at = checkpoints.ticks();
  if (at.size() >= 2) return at[1] - at[0];
  if (at.empty()) return 0;
  constexpr double usual = 0.1;  // [s]
  return std::max(whole_ticks, static_cast<std::int64_t>(std::llround(usual / scenario.time_step)));
}

}  // namespace rehearse
