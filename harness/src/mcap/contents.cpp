#include "contents.h"

#include <fmt/format.h>

#include "codec.h"

namespace rehearse::mcap {

namespace {

void add_too_short(DamageLog& damage, std::string_view what, std::uint64_t offset) {
  damage.add(fmt::format("damaged: the {} at byte {} is too short for what it says", what, offset));
}

void add_contradiction(DamageLog& damage, std::string_view what, std::uint16_t id, std::uint64_t offset) {
  damage.add(fmt::format("damaged: {} {} is defined a second time at byte {}, differently", what, id, offset));
}

}  // namespace

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
  if (schema->id == 0) return;  // the format says: ignore
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

}  // namespace rehearse::mcap
