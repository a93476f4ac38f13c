// The parts of an examination. Internal; doctor.cpp passes over the file, doctor_chunks.cpp examines chunks and their
// indexes, doctor_summary.cpp compares the summary with the file's contents.
#pragma once

#include <map>

#include "doctor.h"
#include "record_pass.h"
#include "resync.h"

namespace rehearse::mcap {

/// A chunk, with the expected contents of its index, and the channels and offsets of its message indexes.
struct ExaminedChunk {
  ChunkIndex index;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes;

  std::uint64_t offset() const { return index.chunk.offset; }
};

/// A channel, and a summary of its messages so far.
struct ExaminedChannel {
  Channel channel;
  std::uint64_t offset = 0;  // offset of its definition
  std::uint64_t messages = 0;
  bool in_chunks = false;  // some of its messages are in chunks
  std::uint64_t last_time = 0;
  std::uint32_t last_sequence = 0;
  std::uint64_t back_in_time = 0;  // number of messages that are earlier than their predecessor
  Place back_at;                   // place of the first of these messages
  std::uint64_t back_by = 0;       // largest step back [ns]
  std::uint64_t jumps = 0;         // number of jumps of its sequence numbers
  Place jump_at;
};

/// An attachment or metadata record.
struct ExaminedRecord {
  std::uint64_t length = 0;  // length of the record with its header
  Attachment attachment;     // the attachment without data; for metadata only name and offset
  std::uint64_t data_size = 0;

  std::uint64_t offset() const { return attachment.offset; }
};

class Doctor {
 public:
  /// `view`: the view of the file's bytes; an empty one if the bytes were passed directly.
  Doctor(const FileView& view, Bytes file, const DoctorOptions& options, Examination& into);
  void examine();

 private:
  // doctor.cpp
  bool pass_to_footer(Record& footer);
  bool skip_damage();
  void examine_record(const Record& record);
  void examine_header(const Record& record);
  void examine_schema(const Record& record, Place place);
  void examine_channel(const Record& record, Place place);
  void examine_attachment(const Record& record);
  void examine_metadata(const Record& record);
  void examine_message(const Record& record, Place place);
  void examine_data_end(const Record& record);
  void examine_channel_profile(const Channel& channel, Place place);
  void tell_channels();
  /// False if the record lacks fields. Reports missing fields and errors in its texts.
  bool check_fields(const Record& record, Place place);
  void add(Severity severity, Place place, std::string message) { findings_.add(severity, place, std::move(message)); }
  void fail(Place place, std::string message) { add(Severity::error, place, std::move(message)); }

  // doctor_chunks.cpp
  void examine_chunk(const Record& record);
  void examine_chunk_records(Bytes records, const Chunk& chunk);
  void examine_message_index(const Record& record);
  void compare_index(const Record& record, std::uint16_t channel, Bytes entries);
  void leave_chunk();

  // doctor_summary.cpp
  void examine_summary(const Record& footer);
  void examine_footer(const Record& record);
  void examine_summary_record(const Record& record);
  void examine_grouping(const Record& record);
  void examine_repeated(const Record& record);
  void examine_chunk_index(const Record& record);
  void examine_record_index(const Record& record, const std::vector<ExaminedRecord>& there, bool attachments);
  void examine_statistics(const Record& record);
  void examine_summary_offset(const Record& record);
  void tell_what_summary_lacks();

  const Bytes file_;
  MappedPass pass_;
  const DoctorOptions& options_;
  Examination& into_;
  Findings& findings_;
  Resync resync_;
  ChunkOpener opener_;
  RawBuffer buffer_;

  // The state of the pass so far.
  bool headed_ = false;
  bool damaged_ = false;  // some record couldn't be examined: counts can't be compared
  std::map<std::uint16_t, std::pair<Schema, std::uint64_t>> schemas_;  // with the offsets of their definitions
  std::map<std::uint16_t, ExaminedChannel> channels_;
  std::vector<ExaminedChunk> chunks_;  // in file order
  std::vector<ExaminedRecord> attachments_;
  std::vector<ExaminedRecord> metadata_;
  std::uint64_t loose_messages_ = 0;
  std::uint64_t loose_at_ = 0;  // offset of the first message outside of chunks
  std::uint64_t messages_ = 0;
  std::uint64_t first_time_ = ~std::uint64_t{0};
  std::uint64_t last_time_ = 0;
  std::optional<std::uint64_t> summary_begin_;  // offset of the first byte after DataEnd

  // The chunk of the following message indexes; at_chunk_ false: there is none.
  bool at_chunk_ = false;
  bool chunk_is_open_ = false;             // the chunk was decompressed, and its messages read
  std::vector<IndexEntry> chunk_entries_;  // sorted by channel, then offset

  // The state of the summary's examination.
  std::vector<std::pair<std::uint8_t, std::pair<std::uint64_t, std::uint64_t>>> groups_;  // opcode, begin, end
  std::map<std::uint16_t, std::uint64_t> repeated_schemas_, repeated_channels_;           // with their offsets
  // parallel to chunks_, attachments_ and metadata_
  std::vector<bool> indexed_chunks_, indexed_attachments_, indexed_metadata_;
  std::optional<std::uint64_t> statistics_at_;
  bool offsets_begun_ = false;
};

}  // namespace rehearse::mcap
