#include "records.h"

#include "codec.h"

#include <algorithm>
#include <concepts>
#include <tuple>
#include <type_traits>
#include <utility>

namespace rehearse::mcap {

void ByteWriter::begin_record(std::uint8_t opcode) {
  record_ = size();
  put(opcode);
  put(std::uint64_t{0});
}

void ByteWriter::end_record() { patch(record_ + 1, static_cast<std::uint64_t>(size() - record_ - 9)); }

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

namespace {

// The fields of each record in the order of its body. The functions take a const record to write it, and a mutable one
// to parse it.
template <class T, class Of>
concept Is = std::same_as<std::remove_const_t<T>, Of>;

auto fields_of(Is<Schema> auto& s) { return std::tie(s.id, s.name, s.encoding, s.data); }

auto fields_of(Is<Channel> auto& c) { return std::tie(c.id, c.schema_id, c.topic, c.message_encoding, c.metadata); }

auto fields_of(Is<Metadata> auto& m) { return std::tie(m.name, m.values); }

auto fields_of(Is<Statistics> auto& s) {
  return std::tie(s.message_count, s.schema_count, s.channel_count, s.attachment_count, s.metadata_count, s.chunk_count,
                  s.message_start_time, s.message_end_time, s.channel_message_counts);
}

auto fields_of(Is<Footer> auto& f) { return std::tie(f.summary_start, f.summary_offset_start, f.summary_crc); }

auto fields_of(Is<ChunkIndex> auto& i) {
  auto& chunk = i.chunk;
  return std::tie(chunk.start_time, chunk.end_time, chunk.offset, i.length, i.places, i.indexes_length,
                  chunk.compression, chunk.stored_size, chunk.size);
}

auto fields_of(Is<RecordPlace> auto& p) { return std::tie(p.offset, p.length); }

template <class T>
std::optional<T> parse(Bytes body) {
  ByteReader in(body);
  T record;
  std::apply([&in](auto&... fields) { (in.get(fields), ...); }, fields_of(record));
  return in.ok() ? std::optional(std::move(record)) : std::nullopt;
}

template <class T>
void put(ByteWriter& out, std::uint8_t opcode, const T& record) {
  std::apply([&](const auto&... fields) { out.put_record(opcode, fields...); }, fields_of(record));
}

}  // namespace

std::optional<Schema> parse_schema(Bytes body) { return parse<Schema>(body); }
std::optional<Channel> parse_channel(Bytes body) { return parse<Channel>(body); }
std::optional<Metadata> parse_metadata(Bytes body) { return parse<Metadata>(body); }
std::optional<Statistics> parse_statistics(Bytes body) { return parse<Statistics>(body); }
std::optional<ChunkIndex> parse_chunk_index(Bytes body) { return parse<ChunkIndex>(body); }
std::optional<RecordPlace> parse_record_place(Bytes body) { return parse<RecordPlace>(body); }

std::optional<Footer> parse_footer(Bytes body) {
  return body.size() == footer_size - record_head ? parse<Footer>(body) : std::nullopt;
}

void put_header(ByteWriter& out, std::string_view profile, std::string_view library) {
  out.put_record(op::header, profile, library);
}

void put_schema(ByteWriter& out, const Schema& schema) { put(out, op::schema, schema); }
void put_channel(ByteWriter& out, const Channel& channel) { put(out, op::channel, channel); }
void put_statistics(ByteWriter& out, const Statistics& statistics) { put(out, op::statistics, statistics); }
void put_chunk_index(ByteWriter& out, const ChunkIndex& index) { put(out, op::chunk_index, index); }

void put_metadata(ByteWriter& out, std::string_view name, const StringMap& values) {
  out.put_record(op::metadata, name, values);
}

void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name) {
  out.put_record(op::metadata_index, offset, length, name);
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

std::optional<StoredChunk> StoredChunk::parse(Bytes file, std::uint64_t offset) {
  if (offset > file.size()) return std::nullopt;
  RecordWalker walker(file, offset);
  Record record;
  if (!walker.next(record) || record.opcode != op::chunk) return std::nullopt;
  const auto head = parse_chunk(record.body);
  if (!head) return std::nullopt;
  StoredChunk stored;
  stored.chunk = {offset,
                  head->start_time,
                  head->end_time,
                  std::string(head->compression),
                  head->records.size(),
                  head->uncompressed_size};
  std::uint64_t end = walker.offset();
  for (; walker.next(record) && record.opcode == op::message_index; end = walker.offset()) {
    ByteReader in(record.body);
    const auto channel = in.get<std::uint16_t>();
    const auto size = in.get<std::uint32_t>();  // size of the entries [bytes]
    if (!in.ok() || size > in.left() || size % index_entry_size != 0) return std::nullopt;
    stored.indexes.push_back({channel, size / index_entry_size, record.offset - offset});
  }
  stored.bytes = file.subspan(offset, end - offset);
  return stored;
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

void put_attachment(ByteWriter& out, const Attachment& attachment) {
  std::vector<std::byte> covered;
  ByteWriter body(covered);
  body.put(attachment.log_time);
  body.put(attachment.create_time);
  body.put(attachment.name);
  body.put(attachment.media_type);
  body.put(static_cast<std::uint64_t>(attachment.data.size()));
  body.put_bytes(attachment.data);
  out.begin_record(op::attachment);
  out.put_bytes(covered);
  out.put(crc32(covered));
  out.end_record();
}

}  // namespace rehearse::mcap
