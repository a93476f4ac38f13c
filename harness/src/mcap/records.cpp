#include "records.h"

#include "codec.h"

#include <algorithm>

namespace rehearse::mcap {

void ByteWriter::put_string(std::string_view text) {
  put(static_cast<std::uint32_t>(text.size()));
  put_bytes(as_bytes(text));
}

void ByteWriter::put_map(const std::map<std::string, std::string>& map) {
  const std::size_t length_at = size();
  put(std::uint32_t{0});
  for (const auto& [key, value] : map) {
    put_string(key);
    put_string(value);
  }
  patch(length_at, static_cast<std::uint32_t>(size() - length_at - 4));
}

void ByteWriter::begin_record(std::uint8_t opcode) {
  record_ = size();
  put(opcode);
  put(std::uint64_t{0});
}

void ByteWriter::end_record() { patch(record_ + 1, static_cast<std::uint64_t>(size() - record_ - 9)); }

std::string ByteReader::get_string() { return std::string(as_text(get_bytes(get<std::uint32_t>()))); }

std::map<std::string, std::string> ByteReader::get_map() {
  ByteReader entries(get_bytes(get<std::uint32_t>()));
  std::map<std::string, std::string> map;
  while (entries.left() > 0) {
    std::string key = entries.get_string();
    std::string value = entries.get_string();
    if (!entries.ok()) break;
    map.insert_or_assign(std::move(key), std::move(value));
  }
  ok_ = ok_ && entries.ok();
  return map;
}

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

std::optional<ChunkHead> parse_chunk_front(Bytes body, std::uint64_t& size) {
  ByteReader in(body);
  ChunkHead head;
  head.start_time = in.get<std::uint64_t>();
  head.end_time = in.get<std::uint64_t>();
  head.uncompressed_size = in.get<std::uint64_t>();
  head.uncompressed_crc = in.get<std::uint32_t>();
  head.compression = as_text(in.get_bytes(in.get<std::uint32_t>()));
  size = in.get<std::uint64_t>();
  head.records = in.rest();
  return in.ok() ? std::optional(head) : std::nullopt;
}

std::optional<ChunkHead> parse_cut_chunk(Bytes body) {
  std::uint64_t size = 0;
  auto head = parse_chunk_front(body, size);
  if (head) head->records = head->records.first(std::min<std::uint64_t>(size, head->records.size()));
  return head;
}

std::optional<ChunkHead> parse_chunk(Bytes body) {
  std::uint64_t size = 0;
  auto head = parse_chunk_front(body, size);
  if (!head || size > head->records.size()) return std::nullopt;
  head->records = head->records.first(size);
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
  index.places = in.get_bytes(in.get<std::uint32_t>());
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

void put_chunk_index(ByteWriter& out, const ChunkIndex& index) {
  out.begin_record(op::chunk_index);
  out.put(index.chunk.start_time);
  out.put(index.chunk.end_time);
  out.put(index.chunk.offset);
  out.put(index.length);
  out.put_string(as_text(index.places));
  out.put(index.indexes_length);
  out.put_string(index.chunk.compression);
  out.put(index.chunk.stored_size);
  out.put(index.chunk.size);
  out.end_record();
}

void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name) {
  out.begin_record(op::metadata_index);
  out.put(offset);
  out.put(length);
  out.put_string(name);
  out.end_record();
}

}  // namespace rehearse::mcap
