// The records of MCAP, parsed and composed one at a time. Internal.
#pragma once

#include <rehearse/mcap.h>

#include "bytes.h"

#include <array>

namespace rehearse::mcap {

inline constexpr std::array<std::byte, 8> magic{std::byte{0x89}, std::byte{'M'},  std::byte{'C'},  std::byte{'A'},
                                                std::byte{'P'},  std::byte{0x30}, std::byte{'\r'}, std::byte{'\n'}};

/// Opcode and length before the body of every record.
inline constexpr std::size_t record_head = 9;
/// Channel, sequence and two times before the data of a message.
inline constexpr std::size_t message_head = 2 + 4 + 8 + 8;
/// Log time and offset of a message in a message index.
inline constexpr std::size_t index_entry_size = 8 + 8;
inline constexpr std::size_t footer_size = record_head + 20;

namespace op {
inline constexpr std::uint8_t header = 0x01, footer = 0x02, schema = 0x03, channel = 0x04, message = 0x05, chunk = 0x06,
                              message_index = 0x07, chunk_index = 0x08, attachment = 0x09, attachment_index = 0x0a,
                              statistics = 0x0b, metadata = 0x0c, metadata_index = 0x0d, summary_offset = 0x0e,
                              data_end = 0x0f;
}  // namespace op

/// A record of the file.
struct Record {
  std::uint8_t opcode = 0;
  Bytes body;                          // without opcode and length
  std::uint64_t offset = 0;            // offset of its opcode, in the file or in the decompressed records of the chunk
  std::optional<std::uint64_t> chunk;  // offset in the file of the chunk that contains it, if any
};

/// The header of a Chunk record and its still compressed records.
struct ChunkHead {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  // 0: none
  std::string_view compression;
  Bytes records;
};

struct Footer {
  std::uint64_t summary_start = 0;
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};

/// The fields of a ChunkIndex record.
struct ChunkIndex {
  Chunk chunk;
  std::uint64_t length = 0;          // length of the chunk's record [bytes]
  std::uint64_t indexes_length = 0;  // length of the message indexes after it [bytes]
  Bytes places;                      // channel (2 bytes) and offset in the file (8) of each message index
};

/// The place of a record, as an AttachmentIndex or a MetadataIndex states it.
struct RecordPlace {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // length of the record with its header [bytes]
};

/// A parsed attachment, and the bytes that its CRC covers.
struct AttachmentRecord {
  Attachment attachment;
  Bytes covered;
  std::uint32_t crc = 0;  // 0: none
};

/// The fields before the data of a message.
struct MessageHead {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::uint64_t publish_time = 0;
};

/// The offset of a message's record in its chunk.
struct IndexEntry {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;
  std::uint16_t channel = 0;
};

/// Iterates over records. Stops at the end of the range, or before the first incomplete record.
class RecordWalker {
 public:
  explicit RecordWalker(Bytes range, std::uint64_t start = 0) : range_(range), offset_(start) {}

  bool next(Record& record);
  /// Offset of the next record; after the last whole record: the end of the walk.
  std::uint64_t offset() const { return offset_; }
  bool at_end() const { return offset_ == range_.size(); }

 private:
  Bytes range_;
  std::uint64_t offset_;
};

/// The whole record with its header. `record` must come from a walk.
inline Bytes bytes_of(const Record& record) {
  return {record.body.data() - record_head, record_head + record.body.size()};
}
/// Offset after the record.
inline std::uint64_t end_of(const Record& record) { return record.offset + record_head + record.body.size(); }

// Each function parses the body of a record. It returns nullopt if the body is shorter than its fields state.
std::optional<Schema> parse_schema(Bytes body);
std::optional<Channel> parse_channel(Bytes body);
std::optional<MessageHead> parse_message_head(Bytes body);
std::optional<ChunkHead> parse_chunk(Bytes body);
std::optional<ChunkHead> parse_cut_chunk(Bytes body);  // its records end with the body, independent of the stated size
/// The fields before the records. `size`: size of the records that the chunk states [bytes].
std::optional<ChunkHead> parse_chunk_front(Bytes body, std::uint64_t& size);
std::optional<AttachmentRecord> parse_attachment(Bytes body);
std::optional<Metadata> parse_metadata(Bytes body);
std::optional<Statistics> parse_statistics(Bytes body);
std::optional<Footer> parse_footer(Bytes body);
std::optional<ChunkIndex> parse_chunk_index(Bytes body);
std::optional<RecordPlace> parse_record_place(Bytes body);

// Each function appends a whole record.
void put_header(ByteWriter& out, std::string_view profile, std::string_view library);
void put_schema(ByteWriter& out, const Schema& schema);
void put_channel(ByteWriter& out, const Channel& channel);
void put_attachment(ByteWriter& out, const Attachment& attachment);
void put_metadata(ByteWriter& out, std::string_view name, const StringMap& values);
void put_statistics(ByteWriter& out, const Statistics& statistics);
void put_chunk_index(ByteWriter& out, const ChunkIndex& index);
/// `length`: length of the record at `offset`, with its header [bytes].
void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name);

}  // namespace rehearse::mcap
