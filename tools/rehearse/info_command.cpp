// rehearse info: prints the contents of a trace, or of any MCAP file.
#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "core/trace/run_facts.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t events_shown = 20;       // without --full
constexpr std::size_t events_in_json = 10000;  // a recording may have millions
/// Files up to this size are read completely without --full, in a fraction of a second [bytes].
constexpr std::uintmax_t small_file = 64'000'000;
/// A log time above this comes from a wall clock, not from a simulation: 1973 [ns].

struct InfoSettings {
  std::string trace;
  bool json = false;
  bool full = false;
  bool schemas = false;
};

/// Counts of the messages of a channel, or of all: from reading them, or from the summary (then without bytes).
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
  bool by_summary = false;                         // bytes, events and damage are unknown
  std::map<std::uint16_t, ChannelCount> channels;  // by id
  ChannelCount all;
  std::uint64_t ticks = 0;  // messages of that type
  std::uint64_t event_count = 0;
  std::vector<msg::Event> events;  // the first ones
  Diagnostics damage;

  std::int64_t ticks_of(const mcap::Reader& reader) const {
    return RunFacts::of(reader).ticks(static_cast<std::int64_t>(ticks));
  }
  double begin() const { return all.messages == 0 ? 0.0 : static_cast<double>(all.first) / 1e9; }  // [s]
  double end() const { return static_cast<double>(all.last) / 1e9; }                               // [s]
  double duration() const {                                                                        // [s]
    return all.messages == 0 ? 0.0 : static_cast<double>(all.last - all.first) / 1e9;
  }
};

std::string type_of(const mcap::Reader& reader, const mcap::Channel& channel) {
  const mcap::Schema* schema = reader.schema_of(channel);
  return schema ? schema->name : "";
}

bool read_event(const mcap::Message& message, msg::Event& event) {
  CdrReader payload(message.data);
  return msg::decode(payload, event);
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
      ++contents.event_count;
      msg::Event event;
      if (contents.events.size() < events_in_json && read_event(message, event))
        contents.events.push_back(std::move(event));
    }
    return true;
  });
  contents.damage = whole.errors();
  return contents;
}

/// Counts from the statistics record. A channel's rate is relative to the time of the whole file.
Contents counts_of_summary(const mcap::Reader& reader) {
  const mcap::Statistics& said = *reader.statistics();
  const auto counted = [&](std::uint64_t messages) {
    return ChannelCount{messages, 0, said.message_start_time, said.message_end_time};
  };
  Contents contents;
  contents.by_summary = true;
  contents.all = counted(said.message_count);
  for (const auto& [id, channel] : reader.channels()) {
    const auto found = said.channel_message_counts.find(id);
    contents.channels[id] = counted(found == said.channel_message_counts.end() ? 0 : found->second);
    const std::string type = type_of(reader, channel);
    if (type == msg::Tick::type_name) contents.ticks += contents.channels[id].messages;
    if (type == msg::Event::type_name) contents.event_count += contents.channels[id].messages;
  }
  return contents;
}

/// The chunks with one compression.
struct Compressed {
  std::uint64_t chunks = 0;
  std::uint64_t stored = 0;   // [bytes]
  std::uint64_t size = 0;     // decompressed [bytes]
  std::uint64_t largest = 0;  // decompressed [bytes]
};

std::map<std::string, Compressed> compressions(const mcap::Reader& reader) {
  std::map<std::string, Compressed> by_name;
  for (const mcap::Chunk& chunk : reader.chunks()) {
    Compressed& all = by_name[chunk.compression.empty() ? "none" : chunk.compression];
    ++all.chunks;
    all.stored += chunk.stored_size;
    all.size += chunk.size;
    all.largest = std::max(all.largest, chunk.size);
  }
  return by_name;
}

Json compressions_json(const mcap::Reader& reader) {
  Json list = Json::array();
  for (const auto& [name, all] : compressions(reader))
    list.push_back({{"compression", name},
                    {"chunks", all.chunks},
                    {"stored_bytes", all.stored},
                    {"bytes", all.size},
                    {"largest_chunk", all.largest}});
  return list;
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
                        {"bytes", contents.by_summary ? Json(nullptr) : Json(counted.bytes)}});
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
  if (contents.by_summary) return nullptr;
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
          {"form", reader.form()},
          {"size", reader.size()},
          {"header", {{"profile", reader.profile()}, {"library", reader.library()}}},
          {"read", contents.by_summary ? "summary" : "all"},
          {"begin", contents.begin()},
          {"duration", contents.duration()},
          {"begin_ns", contents.all.messages == 0 ? 0 : contents.all.first},
          {"end_ns", contents.all.last},
          {"ticks", contents.ticks_of(reader)},
          {"messages", contents.all.messages},
          {"schemas", schemas},
          {"channels", channels_json(reader, contents)},
          {"statistics", statistics_json(reader)},
          {"compression", compressions_json(reader)},
          {"attachments", attachments},
          {"metadata", metadata},
          {"event_count", contents.event_count},
          {"events", events_json(contents)},
          {"damage", json_of(contents.damage)}};
}

bool is_converted(const mcap::Reader& reader) { return reader.form() != "MCAP"; }

void tell_line(std::string_view name, std::string_view value) { fmt::print("{:<13}{}\n", name, value); }

void tell_compressions(const mcap::Reader& reader) {
  std::string_view heading = "compression";
  for (const auto& [name, all] : compressions(reader)) {
    const double share =
        all.size == 0 ? 100.0 : 100.0 * static_cast<double>(all.stored) / static_cast<double>(all.size);
    tell_line(heading, fmt::format("{}: {}, {} of {} ({:.1f} %), the largest {}", plain_text(name),
                                   count_text(all.chunks, "chunk"), file_size_text(all.stored),
                                   file_size_text(all.size), share, file_size_text(all.largest)));
    heading = "";
  }
}

void tell_file(const mcap::Reader& reader, const Contents& contents) {
  tell_line("file", reader.name());
  if (is_converted(reader)) tell_line("form", reader.form());
  tell_line("size", file_size_text(reader.size()));
  tell_line("library", reader.library().empty() ? "unnamed" : plain_text(reader.library()));
  tell_line("profile", reader.profile().empty() ? "none" : plain_text(reader.profile()));
  tell_line("messages",
            fmt::format("{} in {}", contents.all.messages, count_text(reader.channels().size(), "channel")));
  if (contents.ticks > 0) tell_line("ticks", std::to_string(contents.ticks_of(reader)));
  if (contents.all.messages > 0) {
    tell_line("duration", fmt::format("{:.15g} s", contents.duration()));
    tell_line("start", time_text(contents.all.first));
    tell_line("end", time_text(contents.all.last));
  }
  if (!is_converted(reader)) tell_compressions(reader);
}

void tell_channels(const mcap::Reader& reader, const Contents& contents) {
  std::vector<TableRow> rows{{"topic", "type", "encoding", "messages", "rate"}};
  if (!contents.by_summary) rows[0].push_back("payload");
  for (const auto& [id, channel] : reader.channels()) {
    const ChannelCount& counted = contents.channels.at(id);
    rows.push_back({plain_text(channel.topic), plain_text(type_of(reader, channel)),
                    plain_text(channel.message_encoding), std::to_string(counted.messages),
                    counted.rate() > 0.0 ? fmt::format("{:.4g} Hz", counted.rate()) : "-"});
    if (!contents.by_summary) rows.back().push_back(file_size_text(counted.bytes));
  }
  if (rows.size() == 1) return;
  fmt::print("\n");
  print_table(rows);
}

/// Indents all lines of a text but the first.
std::string plain_lines(std::string_view text) {
  std::string lines;
  while (true) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines += plain_text(text.substr(0, end));
    if (end == text.size()) return lines;
    lines += "\n    ";
    text.remove_prefix(end + 1);
  }
}

void tell_records(const mcap::Reader& reader) {
  if (!reader.attachments().empty()) fmt::print("\nattachments\n");
  for (const mcap::Attachment& attachment : reader.attachments())
    fmt::print("  {}, {}, {}\n", plain_text(attachment.name), plain_text(attachment.media_type),
               file_size_text(attachment.data.size()));
  for (const mcap::Metadata& record : reader.metadata()) {
    fmt::print("\nmetadata '{}'\n", plain_text(record.name));
    for (const auto& [key, value] : record.values) fmt::print("  {}: {}\n", plain_text(key), plain_lines(value));
  }
}

/// The definitions of messages. Those of protobuf and flatbuffers are no text.
void tell_schemas(const mcap::Reader& reader) {
  for (const auto& [id, schema] : reader.schemas()) {
    const bool is_text = schema.encoding != "protobuf" && schema.encoding != "flatbuffer";
    fmt::print("\nschema {} of {}\n    {}\n", plain_text(schema.name),
               schema.encoding.empty() ? "no encoding" : "encoding " + plain_text(schema.encoding),
               is_text ? plain_lines(schema.data) : file_size_text(schema.data.size()));
  }
}

void tell_event(const msg::Event& event) {
  fmt::print("  tick {}, {} s: {}: {}: {}\n", event.tick, static_cast<double>(event.stamp.to_ns()) / 1e9,
             event.severity, plain_text(event.source), plain_lines(event.text));
}

/// Reads the events again, because there may be more than fit into memory.
void tell_all_events(mcap::Reader& reader) {
  std::vector<std::uint16_t> chosen;
  for (const auto& [id, channel] : reader.channels())
    if (type_of(reader, channel) == msg::Event::type_name) chosen.push_back(id);
  (void)reader.for_each_message(  // count() has reported the damage
      [](const mcap::Message& message) {
        msg::Event event;
        if (read_event(message, event)) tell_event(event);
        return true;
      },
      chosen);
}

void tell_events(mcap::Reader& reader, const Contents& contents, bool all) {
  if (contents.events.empty()) return;
  fmt::print("\nevents\n");
  if (all) return tell_all_events(reader);
  const std::size_t shown = std::min(contents.events.size(), events_shown);
  for (std::size_t i = 0; i < shown; ++i) tell_event(contents.events[i]);
  if (contents.event_count > shown) fmt::print("  and {} more; --full prints them all\n", contents.event_count - shown);
}

void tell(mcap::Reader& reader, const Contents& contents, const InfoSettings& settings) {
  tell_file(reader, contents);
  tell_channels(reader, contents);
  if (settings.schemas) tell_schemas(reader);
  tell_records(reader);
  tell_events(reader, contents, settings.full);
  if (contents.by_summary)
    fmt::print("\nfrom the file's summary; --full reads the whole file: payloads, {}, checksums\n",
               contents.event_count > 0 ? count_text(contents.event_count, "event") + " and rates of channels"
                                        : "rates of channels");
}

bool is_small(const std::string& file) {
  std::error_code not_a_file;
  const std::uintmax_t size = std::filesystem::file_size(file, not_a_file);
  return not_a_file || size <= small_file;
}

Exit run_info(const InfoSettings& settings) {
  mcap::ReaderOptions options;
  if (!settings.full && !is_small(settings.trace)) options.opening = mcap::Opening::by_summary;
  auto reader = mcap::Reader::open(settings.trace, options);
  if (!reader) return refuse(reader.errors());
  const Contents contents = (*reader)->opened_by_summary() ? counts_of_summary(**reader) : count(**reader);
  if (settings.json) {
    print(trace_json(**reader, contents));
    return contents.damage.empty() ? Exit::done : Exit::bad_input;
  }
  tell(**reader, contents, settings);
  std::fflush(stdout);  // before related output on stderr
  return contents.damage.empty() ? Exit::done : refuse(contents.damage);
}

std::function<Exit()> declare_info(CLI::App& options) {
  const auto settings = std::make_shared<InfoSettings>();
  options
      .add_option(
          "TRACE", settings->trace,
          "a recording, or any other log: MCAP, a rosbag2 folder or database, a bag of ROS 1; -: standard input")
      ->required()
      ->type_name("");
  options.add_flag(
      "--full", settings->full,
      "read all messages and check all checksums, however large the file is, and print all events; else the numbers of "
      "a file of more than 64 MB are those of its summary");
  options.add_flag("--schemas", settings->schemas, "print the definitions of messages, which --json always has");
  add_json_flag(options, settings->json);
  return [settings] { return run_info(*settings); };
}

}  // namespace

extern const Verb info_verb{"info",
                            "  rehearse info sr1.mcap\n"
                            "  rehearse info sr1.mcap --json\n"
                            "  rehearse info log.bag --schemas\n"
                            "  ssh robot cat log.mcap | rehearse info -\n",
                            declare_info};

}  // namespace rehearse::tool
