#include "contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "codec.h"
#include "container.h"

namespace rehearse::mcap {

namespace {

void add_too_short(DamageLog& damage, std::string_view what, std::uint64_t offset) {
  damage.add(fmt::format("damaged: the {} at byte {} is shorter than its fields state", what, offset));
}

void add_contradiction(DamageLog& damage, std::string_view what, std::uint16_t id, std::uint64_t offset) {
  damage.add(fmt::format("damaged: {} {} is defined a second time at byte {}, differently", what, id, offset));
}

}  // namespace

void DamageLog::add(std::string message) {
  if (list_.size() > limit) return;
  if (list_.size() == limit) message = "and more damage after that";
  list_.push_back(error_in(file_, std::move(message)));
}

void DamageLog::add(const DamageLog& other) {
  for (const Diagnostic& diagnostic : other.list_) add(diagnostic.message);
}

void DamageLog::add(const Diagnostics& of_sources) {
  for (const Diagnostic& diagnostic : of_sources)
    if (list_.size() < limit) list_.push_back(diagnostic);
}

void Contents::learn(const Record& record, DamageLog& damage) {
  if (record.opcode == op::schema) learn_schema(record, damage);
  if (record.opcode == op::channel) learn_channel(record, damage);
}

void Contents::learn_header(const Record& record, DamageLog& damage) {
  ByteReader in(record.body);
  profile = in.get_string();
  library = in.get_string();
  if (!in.ok()) damage.add(fmt::format("damaged: the Header at byte {} is too short", record.offset));
}

void Contents::learn_schema(const Record& record, DamageLog& damage) {
  auto schema = parse_schema(record.body);
  if (!schema) return add_too_short(damage, "schema", record.offset);
  if (schema->id == 0) return;  // the specification demands to ignore it
  const auto [place, added] = schemas.try_emplace(schema->id, *schema);
  if (!added && place->second != *schema) add_contradiction(damage, "schema", schema->id, record.offset);
}

void Contents::learn_channel(const Record& record, DamageLog& damage) {
  auto channel = parse_channel(record.body);
  if (!channel) return add_too_short(damage, "channel", record.offset);
  const auto [place, added] = channels.try_emplace(channel->id, *channel);
  if (!added && place->second != *channel) add_contradiction(damage, "channel", channel->id, record.offset);
}

const Schema* Contents::schema_of(const Channel& channel) const {
  const auto found = schemas.find(channel.schema_id);
  return found == schemas.end() ? nullptr : &found->second;
}

bool Contents::has_all_schemas() const {
  return std::ranges::all_of(channels, [this](const auto& entry) {
    return entry.second.schema_id == 0 || schema_of(entry.second) != nullptr;
  });
}

void Contents::add(Contents&& others) {
  schemas.merge(others.schemas);
  channels.merge(others.channels);
  statistics = std::move(others.statistics);
}

Message Contents::read_message(const Record& record, DamageLog& damage) const {
  Message message;
  const std::uint64_t place = record.chunk.value_or(record.offset);
  const auto head = parse_message_head(record.body);
  if (!head) {
    damage.add(fmt::format("damaged: the message at byte {} is too short", place));
    return message;
  }
  const auto channel = channels.find(head->channel);
  if (channel == channels.end()) {
    damage.add(
        fmt::format("damaged: a message at byte {} is of channel {}, which isn't defined", place, head->channel));
    return message;
  }
  message.channel = &channel->second;
  message.sequence = head->sequence;
  message.log_time = head->log_time;
  message.publish_time = head->publish_time;
  message.data = record.body.subspan(message_head);
  message.location = {place, record.chunk ? record.offset : 0, record.chunk.has_value()};
  return message;
}

std::optional<Attachment> read_attachment(const Record& record, bool check_crc, DamageLog& damage) {
  auto parsed = parse_attachment(record.body);
  if (!parsed) {
    add_too_short(damage, "attachment", record.offset);
    return std::nullopt;
  }
  if (check_crc && parsed->crc != 0 && parsed->crc != crc32(parsed->covered)) {
    damage.add(fmt::format("damaged: the CRC of the attachment \"{}\" at byte {} doesn't match",
                           parsed->attachment.name, record.offset));
    return std::nullopt;
  }
  parsed->attachment.offset = record.offset;
  return std::move(parsed->attachment);
}

std::optional<Metadata> read_metadata(const Record& record, DamageLog& damage) {
  auto metadata = parse_metadata(record.body);
  if (!metadata) {
    add_too_short(damage, "Metadata", record.offset);
    return std::nullopt;
  }
  metadata->offset = record.offset;
  return metadata;
}

std::optional<ChunkHead> read_chunk_head(const Record& record, DamageLog& damage) {
  const auto head = parse_chunk(record.body);
  if (!head) add_too_short(damage, "chunk", record.offset);
  return head;
}

bool begins_with_magic(Bytes bytes) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

namespace {

std::string describe_start(Bytes start) {
  constexpr std::size_t version_at = 5;
  if (start.empty()) return "not an MCAP file: it is empty";
  const std::size_t seen = std::min(start.size(), magic.size());
  if (start.size() < magic.size() && std::equal(start.begin(), start.end(), magic.begin())) {
    return fmt::format("truncated at byte {}: the magic bytes of MCAP aren't whole", seen);
  }
  if (seen == magic.size() && std::equal(magic.begin(), magic.begin() + version_at, start.begin())) {
    return "an MCAP file of a version that this reader doesn't support, or damaged in its first eight bytes";
  }
  switch (container_of(start)) {
    case Container::ros1_bag:
      return container_reader() ? "not an MCAP file, but a bag of ROS 1: it is read by its name, not as a stream"
                                : "not an MCAP file, but a bag of ROS 1, which a build with the wing logs reads";
    case Container::sqlite:
      return container_reader() ? "not an MCAP file, but a database: it is read by its name, not as a stream"
                                : "not an MCAP file, but a database, which a build with the wing logs reads";
    case Container::zstd:
      return "not an MCAP file, but a file compressed by zstd: it is read by its name, or zstd -dc FILE";
    default: return "not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n";
  }
}

}  // namespace

Diagnostic not_mcap(std::string file, Bytes start) {
  if (container_of(start) == Container::git_lfs_pointer)
    return error_in(std::move(file), "it is a git-lfs pointer, not the recording that it stands for",
                    "run: git lfs pull");
  return error_in(std::move(file), describe_start(start));
}

std::string describe_cut(const CutPlace& cut) {
  if (cut.ends_with_magic) {
    return fmt::format("damaged at byte {}: no record that fits into the file begins there", cut.record);
  }
  if (cut.record < cut.size && cut.zeros_only) {
    return fmt::format("truncated at byte {}: from there on the file contains zeros only", cut.record);
  }
  return fmt::format("truncated at byte {}: the record that begins at byte {} isn't whole", cut.size, cut.record);
}

bool is_all_zero(Bytes bytes) {
  return std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte{0}; });
}

std::optional<std::uint32_t> read_data_end(const Record& record, DamageLog& damage) {
  ByteReader in(record.body);
  const auto crc = in.get<std::uint32_t>();
  if (!in.ok() || in.left() != 0) {
    damage.add(fmt::format("damaged: the DataEnd record at byte {} doesn't have the length 4", record.offset));
    return std::nullopt;
  }
  return crc == 0 ? std::nullopt : std::optional(crc);
}

std::optional<Footer> read_footer(const Record& record, std::uint64_t summary_start, DamageLog& damage) {
  const auto footer = parse_footer(record.body);
  const bool no_summary = summary_start == record.offset;
  const std::uint64_t expected = no_summary ? 0 : summary_start;
  if (!footer) {
    damage.add(fmt::format("damaged: the Footer at byte {} doesn't have the length 20", record.offset));
    return std::nullopt;
  }
  if (footer->summary_start != expected && !(no_summary && footer->summary_start == record.offset)) {
    damage.add(fmt::format("damaged: the Footer at byte {} states a summary at byte {}, but it begins at byte {}",
                           record.offset, footer->summary_start, expected));
    return std::nullopt;
  }
  return footer;
}

std::optional<Footer> find_footer(Bytes file, std::uint64_t& at) {
  if (file.size() < footer_size + 2 * magic.size() || !begins_with_magic(file.last(magic.size()))) return std::nullopt;
  at = file.size() - magic.size() - footer_size;
  Record record;
  if (!RecordWalker(file, at).next(record) || record.opcode != op::footer) return std::nullopt;
  return parse_footer(record.body);
}

void check_tail(Bytes tail, std::uint64_t offset, DamageLog& damage) {
  if (tail.size() < magic.size()) {
    damage.add(fmt::format("truncated at byte {}: the magic bytes at the end aren't whole", offset + tail.size()));
  } else if (tail.size() > magic.size() || !begins_with_magic(tail)) {
    damage.add(fmt::format("damaged at byte {}: the file doesn't end with its magic bytes there", offset));
  }
}

}  // namespace rehearse::mcap
