#include "trace_doctor.h"

#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <string_view>

#include "base/text.h"
#include "core/kinds/channel_name.h"
#include "core/ros2msg/message_format.h"
#include "run_facts.h"

namespace rehearse {

namespace {

constexpr std::string_view scenario_name = "scenario.yaml";

/// Records by which a file states that it lacks parts of a recording.
constexpr const char* cut_by[] = {"rehearse.filter", "rehearse.merge", "rehearse.recover"};

}  // namespace

void TraceCheck::schema(const mcap::Schema& schema, mcap::Place place, mcap::Findings& findings) {
  const auto problem = ros2msg::problem_of(schema);
  if (problem)
    findings.add(Severity::error, place,
                 fmt::format("Schema {} {} can't be parsed: {}{}", schema.id, in_quotes(schema.name),
                             problem->line > 0 ? fmt::format("line {}: ", problem->line) : "", problem->message));
}

TraceCheck::ChannelState& TraceCheck::state_of(const mcap::Message& message, const mcap::Schema* schema) {
  const auto [place, added] = channels_.try_emplace(message.channel->id);
  ChannelState& state = place->second;
  if (!added || !ros2msg::is_decodable(message.channel->message_encoding, schema)) return state;
  state.topic = message.channel->topic;
  state.type = schema->name;
  state.is_tick = schema->name == msg::Tick::type_name && state.topic == run_topics::tick;
  if (auto parsed = ros2msg::schema_of(message.channel->message_encoding, *schema))
    state.decoder = std::make_unique<ros2msg::Decoder>(std::move(*parsed));
  return state;
}

void TraceCheck::message(const mcap::Message& message, const mcap::Schema* schema, mcap::Place place, mcap::Findings&) {
  ChannelState& state = state_of(message, schema);
  if (!state.decoder) return;
  if (!state.decoder->decode(message.data, [](const ros2msg::Value&) {})) {
    if (state.broken++ == 0) state.broken_at = place;
    return;
  }
  if (state.is_tick) tick(message, place);
}

void TraceCheck::tick(const mcap::Message& message, mcap::Place place) {
  CdrReader reader(message.data);
  msg::Tick tick;
  if (!msg::decode(reader, tick)) return;
  if (ticks_++ == 0) {
    first_tick_ = tick.tick;
  } else if (tick.tick != last_tick_ + 1 && gaps_++ == 0) {
    gap_at_ = place;
    gap_after_ = last_tick_;
    gap_before_ = tick.tick;
  }
  last_tick_ = tick.tick;
}

void TraceCheck::attachment(const mcap::Attachment& attachment, mcap::Findings&) {
  attachments_.push_back(attachment.name);
}

void TraceCheck::metadata(const mcap::Metadata& metadata, mcap::Findings&) {
  if (metadata.name == records::provenance) ++provenances_;
  metadata_[metadata.name] = metadata;
}

void TraceCheck::end(std::uint64_t, mcap::Findings& findings) {
  for (const auto& [id, state] : channels_)
    if (state.broken > 0)
      findings.add(Severity::error, state.broken_at,
                   fmt::format("Channel {} {}: {} of its messages, the first one here, can't be decoded as {}", id,
                               in_quotes(state.topic), state.broken, in_quotes(state.type)));
  if (provenances_ > 0) examine_recording(findings);
}

/// Examines a recording of Rehearse, or a file made from recordings. Parts that the file states as removed or lost are
/// reported as notes.
void TraceCheck::examine_recording(mcap::Findings& findings) const {
  const mcap::Metadata& provenance = metadata_.at(records::provenance);
  const bool cut = std::ranges::any_of(cut_by, [this](const char* name) { return metadata_.contains(name); });
  const Severity severity = cut ? Severity::note : Severity::error;
  if (provenances_ > 1)
    findings.add(severity, {provenance.offset, {}},
                 fmt::format("the file has {} records of provenance: it contains several recordings", provenances_));
  if (!provenance.values.contains(facts::trace_version))
    findings.add(Severity::error, {provenance.offset, {}}, "the recording doesn't state its trace_version");
  if (std::ranges::find(attachments_, scenario_name) == attachments_.end())
    findings.add(severity, {provenance.offset, {}}, fmt::format("the recording has no attachment {}", scenario_name));
  for (const std::string& name : attachments_)
    for (const std::string_view suffix : {".report", ".meshes"})
      if (name.ends_with(suffix) &&
          std::ranges::find(attachments_, name.substr(0, name.size() - suffix.size())) == attachments_.end())
        findings.add(severity, {provenance.offset, {}},
                     fmt::format("the recording has the attachment {}, but not the attachment that it describes",
                                 in_quotes(name)));
  if (gaps_ > 0)
    findings.add(severity, gap_at_,
                 fmt::format("the ticks have {} {}: tick {} comes after tick {}", gaps_, gaps_ == 1 ? "gap" : "gaps",
                             gap_before_, gap_after_));
  if (ticks_ > 0 && first_tick_ != 0)
    findings.add(severity, {provenance.offset, {}}, fmt::format("the recording begins with tick {}", first_tick_));
  if (!cut) examine_outcome(findings);
}

/// Examines the end of the run in a complete recording.
void TraceCheck::examine_outcome(mcap::Findings& findings) const {
  const auto outcome = metadata_.find(records::outcome);
  if (outcome == metadata_.end())
    return findings.add(Severity::error, {metadata_.at(records::provenance).offset, {}},
                        "the recording doesn't state the end of the run: it was cut off");
  const RunOutcome stated = RunOutcome::of(outcome->second.values);
  // A complete run has the state after its last tick as one more tick.
  const std::int64_t there = ticks_ - (ticks_ > 0 && stated.complete ? 1 : 0);
  if (stated.ticks != there)
    findings.add(Severity::error, {outcome->second.offset, {}},
                 fmt::format("the outcome states {} ticks, but the recording has {}",
                             in_quotes(stated.ticks ? std::to_string(*stated.ticks) : ""), there));
}

}  // namespace rehearse
