// rehearse info: what stands in a trace, or in any MCAP file.
#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t events_shown = 20;  // to a person; JSON has them all

struct Settings {
  std::string trace;
  bool json = false;
};

/// What one pass over the messages says of a channel.
struct ChannelCount {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;                                          // of the payloads
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max();  // log time [ns]
  std::uint64_t last = 0;                                           // [ns]

  void add(const mcap::Message& message) {
    ++messages;
    bytes += message.data.size();
    first = std::min(first, message.log_time);
    last = std::max(last, message.log_time);
  }
  double rate() const {  // [Hz]; 0 if there is none
    return messages < 2 || last == first ? 0.0
                                         : static_cast<double>(messages - 1) * 1e9 / static_cast<double>(last - first);
  }
};

struct Contents {
  std::map<std::uint16_t, ChannelCount> channels;  // by id
  ChannelCount all;
  std::uint64_t ticks = 0;
  std::vector<msg::Event> events;
  Diagnostics damage;

  double begin() const { return all.messages == 0 ? 0.0 : static_cast<double>(all.first) / 1e9; }  // [s]
  double end() const { return static_cast<double>(all.last) / 1e9; }                               // [s]
};

std::string type_of(const mcap::Reader& reader, const mcap::Channel& channel) {
  const mcap::Schema* schema = reader.schema_of(channel);
  return schema ? schema->name : "";
}

Contents count(mcap::Reader& reader) {
  Contents contents;
  std::map<std::uint16_t, std::string> types;
  for (const auto& [id, channel] : reader.channels()) {
    types[id] = type_of(reader, channel);
    contents.channels[id];
  }
  const Result<void> whole = reader.for_each_message([&](const mcap::Message& message) {
    const std::string& type = types[message.channel->id];
    contents.channels[message.channel->id].add(message);
    contents.all.add(message);
    if (type == msg::Tick::type_name) ++contents.ticks;
    if (type == msg::Event::type_name) {
      CdrReader payload(message.data);
      msg::Event event;
      if (msg::decode(payload, event)) contents.events.push_back(std::move(event));
    }
    return true;
  });
  contents.damage = whole.errors();
  return contents;
}

Json channels_json(const mcap::Reader& reader, const Contents& contents) {
  Json channels = Json::array();
  for (const auto& [id, channel] : reader.channels()) {
    const ChannelCount& counted = contents.channels.at(id);
    channels.push_back({{"id", id},
                        {"topic", channel.topic},
                        {"type", type_of(reader, channel)},
                        {"schema_id", channel.schema_id},
                        {"message_encoding", channel.message_encoding},
                        {"metadata", channel.metadata},
                        {"messages", counted.messages},
                        {"rate", counted.rate()},
                        {"bytes", counted.bytes}});
  }
  return channels;
}

Json statistics_json(const mcap::Reader& reader) {
  if (!reader.statistics()) return nullptr;
  const mcap::Statistics& stated = *reader.statistics();
  Json counts = Json::object();
  for (const auto& [id, messages] : stated.channel_message_counts) counts[std::to_string(id)] = messages;
  return {{"message_count", stated.message_count},
          {"schema_count", stated.schema_count},
          {"channel_count", stated.channel_count},
          {"attachment_count", stated.attachment_count},
          {"metadata_count", stated.metadata_count},
          {"chunk_count", stated.chunk_count},
          {"message_start_time", stated.message_start_time},
          {"message_end_time", stated.message_end_time},
          {"channel_message_counts", counts}};
}

Json events_json(const Contents& contents) {
  Json events = Json::array();
  for (const msg::Event& event : contents.events)
    events.push_back({{"tick", event.tick},
                      {"time", static_cast<double>(event.stamp.to_ns()) / 1e9},
                      {"severity", event.severity},
                      {"source", event.source},
                      {"text", event.text}});
  return events;
}

Json trace_json(const mcap::Reader& reader, const Contents& contents) {
  Json schemas = Json::array();
  for (const auto& [id, schema] : reader.schemas())
    schemas.push_back({{"id", id}, {"name", schema.name}, {"encoding", schema.encoding}, {"data", schema.data}});
  Json attachments = Json::array();
  for (const mcap::Attachment& attachment : reader.attachments())
    attachments.push_back(
        {{"name", attachment.name}, {"media_type", attachment.media_type}, {"size", attachment.data.size()}});
  Json metadata = Json::array();
  for (const mcap::Metadata& record : reader.metadata())
    metadata.push_back({{"name", record.name}, {"values", record.values}});
  return {{"file", reader.name()},
          {"size", reader.size()},
          {"header", {{"profile", reader.profile()}, {"library", reader.library()}}},
          {"begin", contents.begin()},
          {"duration", contents.end() - contents.begin()},
          {"ticks", contents.ticks},
          {"messages", contents.all.messages},
          {"schemas", schemas},
          {"channels", channels_json(reader, contents)},
          {"statistics", statistics_json(reader)},
          {"attachments", attachments},
          {"metadata", metadata},
          {"events", events_json(contents)},
          {"damage", json_of(contents.damage)}};
}

void tell_channels(const mcap::Reader& reader, const Contents& contents) {
  std::vector<TableRow> rows{{"topic", "type", "messages", "rate", "payload"}};
  for (const auto& [id, channel] : reader.channels()) {
    const ChannelCount& counted = contents.channels.at(id);
    rows.push_back({channel.topic, type_of(reader, channel), std::to_string(counted.messages),
                    counted.rate() > 0.0 ? fmt::format("{:.4g} Hz", counted.rate()) : "-",
                    file_size_text(counted.bytes)});
  }
  if (rows.size() > 1) print_table(rows);
}

void tell_records(const mcap::Reader& reader) {
  if (!reader.attachments().empty()) fmt::print("\nattachments\n");
  for (const mcap::Attachment& attachment : reader.attachments())
    fmt::print("  {}, {}, {}\n", attachment.name, attachment.media_type, file_size_text(attachment.data.size()));
  for (const mcap::Metadata& record : reader.metadata()) {
    fmt::print("\nmetadata '{}'\n", record.name);
    for (const auto& [key, value] : record.values) fmt::print("  {}: {}\n", key, value);
  }
}

void tell_events(const Contents& contents) {
  if (contents.events.empty()) return;
  fmt::print("\nevents\n");
  for (std::size_t i = 0; i < std::min(contents.events.size(), events_shown); ++i) {
    const msg::Event& event = contents.events[i];
    fmt::print("  tick {}, {} s: {}: {}: {}\n", event.tick, static_cast<double>(event.stamp.to_ns()) / 1e9,
               event.severity, event.source, event.text);
  }
  if (contents.events.size() > events_shown)
    fmt::print("  and {} more; --json lists them all\n", contents.events.size() - events_shown);
}

void tell(const mcap::Reader& reader, const Contents& contents) {
  fmt::print("{}: {}, written by {}{}\n", reader.name(), file_size_text(reader.size()),
             reader.library().empty() ? "an unnamed library" : reader.library(),
             reader.profile().empty() ? "" : ", profile " + reader.profile());
  fmt::print("{} in {}, {:g} s from {:g} s to {:g} s",
             count_text(static_cast<std::int64_t>(contents.all.messages), "message"),
             count_text(static_cast<std::int64_t>(reader.channels().size()), "channel"),
             contents.end() - contents.begin(), contents.begin(), contents.end());
  fmt::print("{}\n\n",
             contents.ticks > 0
                 ? fmt::format(", {} on /tick", count_text(static_cast<std::int64_t>(contents.ticks), "message"))
                 : "");
  tell_channels(reader, contents);
  tell_records(reader);
  tell_events(contents);
}

Exit run(const Settings& settings) {
  auto reader = mcap::Reader::open(settings.trace);
  if (!reader) return refuse(reader.errors());
  const Contents contents = count(**reader);
  if (settings.json) {
    print(trace_json(**reader, contents));
    return contents.damage.empty() ? Exit::done : Exit::bad_input;
  }
  tell(**reader, contents);
  std::fflush(stdout);  // before what stderr says of it
  return contents.damage.empty() ? Exit::done : refuse(contents.damage);
}

std::function<Exit()> declare(CLI::App& options) {
  const auto settings = std::make_shared<Settings>();
  options.add_option("TRACE", settings->trace, "a recording, or any other MCAP file")->required()->type_name("");
  add_json_flag(options, settings->json);
  return [settings] { return run(*settings); };
}

}  // namespace

const Verb info_verb{"info",
                     "  rehearse info sr1.mcap\n"
                     "  rehearse info sr1.mcap --json\n",
                     declare};

}  // namespace rehearse::tool
