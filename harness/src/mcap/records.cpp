#include "records.h"

#include "codec.h"

#include <algorithm>

namespace rehearse::mcap {

bool RecordWalker::next(Record& record) {
  const Bytes left = range_.subspan(offset_);
  if (left.size() < record_head) return false;
  ByteReader in(left);
  const auto opcode = in.get<std::uint8_t>();
  const auto length = in.get<std::uint64_t>();
  if (opcode == 0 || length > in.left()) return false;
  record.opcode = opcode;
  record.body = in.get_bytes(length);
  record.offset = offset_;
  offset_ += record_head + length;
  return true;
}

std::optional<Schema> parse_schema(Bytes body) {
  ByteReader in(body);
  Schema schema;
  schema.id = in.get<std::uint16_t>();
  schema.name = in.get_string();
  schema.encoding = in.get_string();
  schema.data = in.get_string();
  return in.ok() ? std::optional(std::move(schema)) : std::nullopt;
}

std::optional<Channel> parse_channel(Bytes body) {
  ByteReader in(body);
  Channel channel;
  channel.id = in.get<std::uint16_t>();
  channel.schema_id = in.get<std::uint16_t>();
  channel.topic = in.get_string();
  channel.message_encoding = in.get_string();
  channel.metadata = in.get_map();
  return in.ok() ? std::optional(std::move(channel)) : std::nullopt;
}

std::optional<MessageHead> parse_message_head(Bytes body) {
  if (body.size() < message_head) return std::nullopt;
  MessageHead head;
  std::memcpy(&head.channel, body.data(), 2);
  std::memcpy(&head.sequence, body.data() + 2, 4);
  std::memcpy(&head.log_time, body.data() + 6, 8);
  std::memcpy(&head.publish_time, body.data() + 14, 8);
  return head;
}

namespace {

/// The head; `in` stands before the length of the records then.
ChunkHead take_chunk_head(ByteReader& in) {
  ChunkHead head;
  head.start_time = in.get<std::uint64_t>();
  head.end_time = in.get<std::uint64_t>();
  head.uncompressed_size = in.get<std::uint64_t>();
  head.uncompressed_crc = in.get<std::uint32_t>();
  head.compression = as_text(in.get_bytes(in.get<std::uint32_t>()));
  return head;
}

}  // namespace

std::optional<ChunkHead> parse_chunk(Bytes body) {
  ByteReader in(body);
  ChunkHead head = take_chunk_head(in);
  head.records = in.get_bytes(in.get<std::uint64_t>());
  return in.ok() ? std::optional(head) : std::nullopt;
}

std::optional<ChunkHead> parse_cut_chunk(Bytes body) {
  ByteReader in(body);
  ChunkHead head = take_chunk_head(in);
  const auto length = in.get<std::uint64_t>();
  if (!in.ok()) return std::nullopt;
  head.records = in.rest().first(std::min<std::uint64_t>(length, in.left()));
  return head;
}

std::optional<AttachmentRecord> parse_attachment(Bytes body) {
  ByteReader in(body);
  AttachmentRecord record;
  record.attachment.log_time = in.get<std::uint64_t>();
  record.attachment.create_time = in.get<std::uint64_t>();
  record.attachment.name = in.get_string();
  record.attachment.media_type = in.get_string();
  record.attachment.data = in.get_bytes(in.get<std::uint64_t>());
  record.covered = body.first(body.size() - in.left());
  record.crc = in.get<std::uint32_t>();
  return in.ok() ? std::optional(std::move(record)) : std::nullopt;
}

std::optional<Metadata> parse_metadata(Bytes body) {
  ByteReader in(body);
  Metadata metadata;
  metadata.name = in.get_string();
  metadata.values = in.get_map();
  return in.ok() ? std::optional(std::move(metadata)) : std::nullopt;
}

std::optional<Statistics> parse_statistics(Bytes body) {
  ByteReader in(body);
  Statistics s;
  s.message_count = in.get<std::uint64_t>();
  s.schema_count = in.get<std::uint16_t>();
  s.channel_count = in.get<std::uint32_t>();
  s.attachment_count = in.get<std::uint32_t>();
  s.metadata_count = in.get<std::uint32_t>();
  s.chunk_count = in.get<std::uint32_t>();
  s.message_start_time = in.get<std::uint64_t>();
  s.message_end_time = in.get<std::uint64_t>();
  ByteReader counts(in.get_bytes(in.get<std::uint32_t>()));
  while (counts.left() > 0 && counts.ok()) {
    const auto channel = counts.get<std::uint16_t>();
    const auto count = counts.get<std::uint64_t>();
    if (counts.ok()) s.channel_message_counts[channel] = count;
  }
  return in.ok() && counts.ok() ? std::optional(std::move(s)) : std::nullopt;
}

std::optional<Footer> parse_footer(Bytes body) {
  ByteReader in(body);
  Footer footer;
  footer.summary_start = in.get<std::uint64_t>();
  footer.summary_offset_start = in.get<std::uint64_t>();
  footer.summary_crc = in.get<std::uint32_t>();
  return in.ok() && in.left() == 0 ? std::optional(footer) : std::nullopt;
}

std::optional<ChunkIndex> parse_chunk_index(Bytes body) {
  ByteReader in(body);
  ChunkIndex index;
  index.chunk.start_time = in.get<std::uint64_t>();
  index.chunk.end_time = in.get<std::uint64_t>();
  index.chunk.offset = in.get<std::uint64_t>();
  index.length = in.get<std::uint64_t>();
  in.get_bytes(in.get<std::uint32_t>());  // where the message indexes are
  index.indexes_length = in.get<std::uint64_t>();
  index.chunk.compression = in.get_string();
  index.chunk.stored_size = in.get<std::uint64_t>();
  index.chunk.size = in.get<std::uint64_t>();
  return in.ok() ? std::optional(std::move(index)) : std::nullopt;
}

std::optional<RecordPlace> parse_record_place(Bytes body) {
  ByteReader in(body);
  RecordPlace place;
  place.offset = in.get<std::uint64_t>();
  place.length = in.get<std::uint64_t>();
  return in.ok() ? std::optional(place) : std::nullopt;
}

void put_header(ByteWriter& out, std::string_view profile, std::string_view library) {
  out.begin_record(op::header);
  out.put_string(profile);
  out.put_string(library);
  out.end_record();
}

void put_schema(ByteWriter& out, const Schema& schema) {
  out.begin_record(op::schema);
  out.put(schema.id);
  out.put_string(schema.name);
  out.put_string(schema.encoding);
  out.put_string(schema.data);
  out.end_record();
}

void put_channel(ByteWriter& out, const Channel& channel) {
  out.begin_record(op::channel);
  out.put(channel.id);
  out.put(channel.schema_id);
  out.put_string(channel.topic);
  out.put_string(channel.message_encoding);
  out.put_map(channel.metadata);
  out.end_record();
}

void put_attachment(ByteWriter& out, const Attachment& attachment, bool with_crc) {
  std::vector<std::byte> covered;
  ByteWriter body(covered);
  body.put(attachment.log_time);
  body.put(attachment.create_time);
  body.put_string(attachment.name);
  body.put_string(attachment.media_type);
  body.put(static_cast<std::uint64_t>(attachment.data.size()));
  body.put_bytes(attachment.data);
  out.begin_record(op::attachment);
  out.put_bytes(covered);
  out.put(with_crc ? crc32(covered) : 0u);
  out.end_record();
}

void put_metadata(ByteWriter& out, std::string_view name, const StringMap& values) {
  out.begin_record(op::metadata);
  out.put_string(name);
  out.put_map(values);
  out.end_record();
}

void put_statistics(ByteWriter& out, const Statistics& s) {
  out.begin_record(op::statistics);
  out.put(s.message_count);
  out.put(s.schema_count);
  out.put(s.channel_count);
  out.put(s.attachment_count);
  out.put(s.metadata_count);
  out.put(s.chunk_count);
  out.put(s.message_start_time);
  out.put(s.message_end_time);
  out.put(static_cast<std::uint32_t>(s.channel_message_counts.size() * 10));
  for (const auto& [channel, count] : s.channel_message_counts) {
    out.put(channel);
    out.put(count);
  }
  out.end_record();
}

}  // namespace rehearse::mcap
