#include "partial_candidate.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/compare.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/clock.h"
#include "base/glob.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

std::uint64_t nanoseconds(double seconds) {
  constexpr double most = 1e18;
  return static_cast<std::uint64_t>(std::llround(std::clamp(seconds * 1e9, 0.0, most)));
}

/// True for topics that are computed from other messages of their tick: they come from the source of those messages.
bool is_derived(std::string_view topic) {
  const ChannelKind kind = ChannelName::parse(topic).kind;
  return kind == ChannelKind::tick || kind == ChannelKind::checkpoint || kind == ChannelKind::transforms ||
         kind == ChannelKind::events;
}

template <class T>
bool decode(const std::vector<std::byte>& data, T& message) {
  CdrReader reader(data);
  return msg::decode(reader, message);
}

template <class T>
std::vector<std::byte> encode(const T& message) {
  CdrWriter writer;
  msg::encode(message, writer);
  return {writer.bytes().begin(), writer.bytes().end()};
}

const std::vector<std::uint64_t>& tick_times(const Trace& trace) {
  static const std::vector<std::uint64_t> none;
  const TraceChannel* ticks = trace.find_channel(run_topics::tick);
  return ticks ? ticks->times : none;
}

}  // namespace

Result<PartialCandidate> PartialCandidate::make(const Trace& golden, const Trace& run, const Selection& selection) {
  PartialCandidate candidate;
  REHEARSE_TRY(candidate.choose_parts(golden, run, selection));
  REHEARSE_TRY(candidate.compare_structure(golden, run));

  const auto read = [&candidate](const Trace& trace) -> Result<std::map<std::uint64_t, std::vector<Message>>> {
    std::map<std::uint64_t, std::vector<Message>> by_time;
    const auto reader = REHEARSE_TRY(mcap::Reader::open(trace.file()));
    REHEARSE_TRY(reader->for_each_message_in_order([&](const mcap::Message& message) {
      const std::string_view topic = *candidate.topics_.insert(message.channel->topic).first;
      by_time[message.log_time].push_back({topic, message.log_time, {message.data.begin(), message.data.end()}});
      return true;
    }));
    return by_time;
  };
  auto of_run = REHEARSE_TRY(read(run));
  auto of_golden = REHEARSE_TRY(read(golden));
  for (const auto& [time, messages] : of_golden) of_run.try_emplace(time);
  for (auto& [time, messages] : of_run)
    REHEARSE_TRY(candidate.mix_tick(std::move(messages), std::move(of_golden[time])));
  return candidate;
}

Result<void> PartialCandidate::choose_parts(const Trace& golden, const Trace& run, const Selection& selection) {
  from_ = nanoseconds(selection.from);
  until_ = selection.until ? nanoseconds(*selection.until) : std::numeric_limits<std::uint64_t>::max();
  if (until_ <= from_) return error(fmt::format("{} is no span of time", to_string(selection)));
  std::set<std::string> used;
  for (const Trace* trace : {&run, &golden})
    for (const TraceChannel& channel : trace->channels()) choose_part(channel, selection, used);
  for (const std::string& pattern : selection.channels)
    if (!used.contains(pattern))
      return error(fmt::format("'{}' is no channel and no series of the run or of the golden", pattern),
                   fmt::format("rehearse info {} shows the channels; * stands for any text", run.file()));
  return {};
}

void PartialCandidate::choose_part(const TraceChannel& channel, const Selection& selection,
                                   std::set<std::string>& used) {
  Part& part = parts_[channel.topic];
  if (selection.channels.empty()) part.whole = true;
  for (const std::string& pattern : selection.channels) {
    const std::string_view topic = channel.topic;
    if (matches(pattern, topic) || (topic.starts_with('/') && matches(pattern, topic.substr(1)))) {
      part.whole = true;
      used.insert(pattern);
    }
    for (const TraceColumn& column : channel.columns)
      if (matches(pattern, column.series)) {
        part.elements.insert(column.element);
        used.insert(pattern);
      }
  }
  const auto chosen = [&part](const TraceColumn& column) { return part.elements.contains(column.element); };
  if (!channel.columns.empty() && std::ranges::all_of(channel.columns, chosen)) part.whole = true;
}

/// Fails if mixing would require new times or new messages.
Result<void> PartialCandidate::compare_structure(const Trace& golden, const Trace& run) const {
  if (tick_times(golden) != tick_times(run))
    return error(fmt::format("the run has {} ticks and the golden {}, or their times differ: no part of one fits into "
                             "the other",
                             run.ticks(), golden.ticks()),
                 "accept all of the run");
  for (const auto& [topic, part] : parts_) {
    const TraceChannel *of_golden = golden.find_channel(topic), *of_run = run.find_channel(topic);
    if (of_golden && of_run && of_golden->type == of_run->type) continue;
    if ((part.whole && from_ == 0 && until_ == std::numeric_limits<std::uint64_t>::max()) ||
        topic == run_topics::events)
      continue;
    return error(fmt::format("the channel {} {}, so the golden can't keep it unchanged", topic,
                             !of_run      ? "isn't in the run"
                             : !of_golden ? "isn't in the golden"
                                          : "has another type in the run"),
                 fmt::format("accept it too: --channel '{}'", topic));
  }
  return {};
}

bool PartialCandidate::is_selected(const Message& message) const {
  return parts_.find(message.topic)->second.whole && message.time >= from_ && message.time < until_;
}

/// Mixes messages of one tick; each list is in the order of recording.
Result<void> PartialCandidate::mix_tick(std::vector<Message> run, std::vector<Message> golden) {
  TickSources sources;
  std::vector<bool> used(golden.size(), false);
  const auto counterpart = [&](const Message& message) -> const Message* {
    for (std::size_t i = 0; i < golden.size(); ++i)
      if (!used[i] && golden[i].topic == message.topic) return used[i] = true, &golden[i];
    return nullptr;
  };
  std::vector<std::pair<Message, const Message*>> derived;  // each with the golden's message
  for (Message& message : run) {
    const Message* of_golden = counterpart(message);
    if (is_derived(message.topic)) {
      derived.emplace_back(std::move(message), of_golden);
      continue;
    }
    const bool differs = !of_golden || of_golden->data != message.data;
    const Part& part = parts_.find(message.topic)->second;
    const bool some = !part.whole && !part.elements.empty() && message.time >= from_ && message.time < until_;
    if (differs && some && of_golden) {
      auto data = REHEARSE_TRY(mix_joints(part, message, *of_golden));
      account(message, false, data != message.data, sources);
      account(message, true, data != of_golden->data, sources);
      message.data = std::move(data);
    } else if (is_selected(message)) {
      account(message, true, differs, sources);
    } else {
      account(message, false, differs, sources);
      if (!of_golden) continue;
      message.data = of_golden->data;
    }
    messages_.push_back(std::move(message));
  }
  for (std::size_t i = 0; i < golden.size(); ++i) {
    if (used[i]) continue;
    const bool dropped = is_selected(golden[i]);
    account(golden[i], dropped, true, sources);
    if (!dropped) messages_.push_back(golden[i]);
  }
  for (auto& [message, of_golden] : derived) {
    follow(message, of_golden, sources);
    messages_.push_back(std::move(message));
  }
  // The inputs of a controller are a copy of the state: both must come from one run.
  const Sources &state = sources.of(Stage::physics), &inputs = sources.of(Stage::inputs);
  const std::uint64_t time = run.empty() ? golden[0].time : run[0].time;
  if (!state.run.empty() && !inputs.golden.empty()) note_mixed(time, inputs.golden, state.run);
  if (!inputs.run.empty() && !state.golden.empty()) note_mixed(time, state.golden, inputs.run);
  return {};
}

/// The golden's message with the selected elements of the run's.
Result<std::vector<std::byte>> PartialCandidate::mix_joints(const Part& part, const Message& run,
                                                            const Message& golden) const {
  msg::JointState mixed, other;
  if (!decode(golden.data, mixed) || !decode(run.data, other) || mixed.name != other.name ||
      encode(mixed) != golden.data)
    return error(fmt::format("the messages on {} are accepted whole, or not at all", run.topic),
                 fmt::format("--channel '{}'", run.topic));
  const auto take = [&](std::vector<double>& into, const std::vector<double>& from, const char* quantity) {
    for (std::size_t i = 0; i < std::min({into.size(), from.size(), mixed.name.size()}); ++i)
      if (part.elements.contains(mixed.name[i] + quantity)) into[i] = from[i];
  };
  take(mixed.position, other.position, "/q");
  take(mixed.velocity, other.velocity, "/dq");
  take(mixed.effort, other.effort, "/u");
  return encode(mixed);
}

void PartialCandidate::account(const Message& message, bool from_run, bool differs, TickSources& sources) {
  if (!differs) return;
  Sources& stage = sources.of(stage_of(message.topic));
  std::string_view& topic = from_run ? stage.run : stage.golden;
  if (topic.empty()) topic = message.topic;
  if (from_run)
    anything_moves_ = true;
  else
    keep_account_of(message.topic);
}

void PartialCandidate::keep_account_of(std::string_view topic) {
  if (std::ranges::find(moved_but_kept_, topic) == moved_but_kept_.end()) moved_but_kept_.emplace_back(topic);
}

/// Uses the golden's content where the sources of the message are the golden's. `message` is the run's.
void PartialCandidate::follow(Message& message, const Message* golden, TickSources& sources) {
  if (message.topic == run_topics::tick && golden) return follow_tick(message, *golden, sources);
  if (!golden || is_selected(message)) return;
  const Sources& state = sources.of(message.topic == run_topics::events ? Stage::controller : Stage::physics);
  if (state.run.empty()) message.data = golden->data;
}

void PartialCandidate::follow_tick(Message& message, const Message& golden, TickSources& sources) {
  msg::Tick of_run, of_golden;
  if (!decode(message.data, of_run) || !decode(golden.data, of_golden)) return;
  if (is_selected(message)) of_golden = of_run;
  msg::Tick mixed = of_golden;
  // The first stage that differs decides: if other inputs differ, pictures don't matter. The second execution of the
  // candidate checks the hashes of state and inputs.
  const auto follow = [&](std::uint64_t msg::Tick::*hash, std::initializer_list<Stage> stages) {
    for (const Stage stage : stages) {
      const Sources& of_stage = sources.of(stage);
      if (of_stage.run.empty() && of_stage.golden.empty()) continue;
      if (!of_stage.run.empty()) mixed.*hash = of_run.*hash;
      return;
    }
  };
  follow(&msg::Tick::state_hash, {Stage::physics});
  follow(&msg::Tick::input_hash, {Stage::inputs, Stage::sensors, Stage::renderer});
  follow(&msg::Tick::output_hash, {Stage::controller});
  const Sources& outputs = sources.of(Stage::controller);
  if (!outputs.run.empty() && !outputs.golden.empty()) note_mixed(message.time, outputs.golden, outputs.run);
  if (!sources.of(Stage::controller).run.empty()) mixed.controller_results = of_run.controller_results;
  if (std::exchange(first_tick_, false) && mixed.state_hash != of_run.state_hash)
    other_start_ =
        fmt::format("it would begin in another state than a run of its scenario does, at tick {}", mixed.tick);
  message.data = encode(mixed);
}

void PartialCandidate::note_mixed(std::uint64_t time, std::string_view kept, std::string_view accepted) {
  if (!mixed_)
    mixed_ = fmt::format("at {} s {} is kept and {} is accepted, but both must come from one run", seconds_of(time),
                         kept, accepted);
}

Result<void> PartialCandidate::write(const Trace& run, const mcap::StringMap& controllers,
                                     const std::filesystem::path& file) const {
  auto writer = REHEARSE_TRY(mcap::Writer::create(file));
  mcap::Writer& out = *writer;
  for (const mcap::Attachment& attachment : run.attachments())
    REHEARSE_TRY(out.add_attachment(attachment.name, attachment.media_type, attachment.data));
  const auto write_metadata = [&](bool outcome) -> Result<void> {
    for (const mcap::Metadata& metadata : run.metadata()) {
      if ((metadata.name == records::outcome) != outcome || metadata.name.starts_with(acceptance_prefix)) continue;
      mcap::StringMap values = metadata.values;
      if (metadata.name == records::provenance)
        for (const auto& [controller, library] : controllers) values[controller] = library;
      REHEARSE_TRY(out.add_metadata(metadata.name, values));
    }
    return {};
  };
  REHEARSE_TRY(write_metadata(false));
  const auto reader = REHEARSE_TRY(mcap::Reader::open(run.file()));
  std::map<std::string, std::uint16_t, std::less<>> channels;
  for (const auto& [id, channel] : reader->channels()) {
    const mcap::Schema* schema = reader->schema_of(channel);
    const std::uint16_t schema_id = schema ? out.add_schema(schema->name, schema->encoding, schema->data) : 0;
    channels[channel.topic] = out.add_channel(schema_id, channel.topic, channel.message_encoding, channel.metadata,
                                              chunk_group_of(ChannelName::parse(channel.topic)));
  }
  for (const Message& message : messages_)
    if (const auto channel = channels.find(message.topic); channel != channels.end())
      REHEARSE_TRY(out.write(channel->second, message.time, message.time, message.data));
  REHEARSE_TRY(write_metadata(true));
  return out.close();
}

}  // namespace rehearse
