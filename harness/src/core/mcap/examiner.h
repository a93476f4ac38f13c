// The pass of an examination. Internal; examiner.cpp passes over the file, examiner_chunks.cpp examines chunks and
// their indexes, examiner_summary.cpp compares the summary with the file's contents.
#pragma once

#include <map>
#include <set>

#include "examination.h"
#include "record_layout.h"
#include "record_pass.h"
#include "resync.h"

namespace rehearse::mcap {

/// A chunk, with the expected contents of its index, and the channels and offsets of its message indexes.
struct ExaminedChunk {
  ChunkIndex index;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes;

  std::uint64_t offset() const { return index.chunk.offset; }
};

/// The definition of a schema or channel.
struct ExaminedDefinition {
  std::uint64_t offset = 0;
  bool in_data = false;  // false: so far only the summary has it
};

/// A channel, and a summary of its messages so far.
struct ExaminedChannel : ExaminedDefinition {
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

class Examiner {
 public:
  /// `view`: the view of the file's bytes; an empty one if the bytes were passed directly.
  Examiner(const FileView& view, Bytes file, const ExamineOptions& options, Examination& into);
  void examine();

 private:
  /// The reason why a record is lost, and its place in the records of a chunk, if any.
  struct Fault {
    std::string message;
    std::optional<std::uint64_t> inside = {};
  };
  using Verdict = std::optional<Fault>;  // nullopt: the record is saved

  // examiner.cpp
  void read_definitions_of_summary();
  void learn(const Record& definition);
  std::optional<Record> walk();
  void tell_cut(std::uint64_t begin);
  bool is_cut_chunk(std::uint64_t offset) const;
  void examine_end(const Record& footer);
  Verdict examine_record(const Record& record);
  /// Reports the texts of a record that are wrong, and fields of later versions.
  void tell_fields(const Record& record, Place place, const LayoutCheck& layout);
  template <class Known, class Parsed>
  static bool learn(Known& known, const Parsed& parsed, ExaminedDefinition& at, std::uint64_t offset);
  void examine_header(const Record& record);
  Verdict examine_schema(const Record& record, Place place);
  Verdict examine_channel(const Record& record, Place place);
  Verdict examine_attachment(const Record& record);
  void examine_metadata(const Record& record);
  void examine_message(const Record& record, Place place);
  void examine_data_end(const Record& record);
  void tell_channels();
  void tell_deviations();
  void save(std::uint64_t begin, std::uint64_t end, bool trusted = true);
  void lose(std::uint64_t begin, std::uint64_t end, Fault fault, bool is_error = true);
  void fail(Place place, std::string message) { findings_.add(Severity::error, place, std::move(message)); }
  /// Notes a deviation from the specification that harms no reader. All of them are one finding.
  void deviate(Place place, std::string what);

  // examiner_chunks.cpp
  Verdict examine_chunk(const Record& record);
  void examine_chunk_records(Bytes records, const Chunk& chunk);
  void examine_message_index(const Record& record);
  void compare_index(const Record& record, std::uint16_t channel, Bytes entries);
  void leave_chunk();

  // examiner_summary.cpp
  void examine_summary(const Record& footer);
  void examine_footer(const Record& record, const Footer& footer);
  void examine_summary_record(const Record& record);
  void examine_grouping(const Record& record);
  void examine_repeated(const Record& record);
  void examine_chunk_index(const Record& record);
  void examine_record_index(const Record& record, const std::vector<ExaminedRecord>& there, bool attachments);
  void examine_statistics(const Record& record);
  void examine_summary_offset(const Record& record);
  void tell_missing_parts();

  const Bytes file_;
  RecordPass pass_;
  const ExamineOptions& options_;
  Examination& into_;
  Findings& findings_;
  Contents& contents_;
  Resync resync_;
  ChunkOpener opener_;
  RawBuffer buffer_;

  // The state of the pass so far.
  bool begun_ = false;
  bool headed_ = false;
  bool damaged_ = false;  // some record couldn't be examined: counts can't be compared
  std::map<std::uint16_t, ExaminedDefinition> schemas_;
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
  bool chunk_is_open_ = false;             // its messages were read; false: it is lost
  std::vector<IndexEntry> chunk_entries_;  // sorted by channel, then offset

  // The state of the summary's examination.
  std::vector<std::pair<std::uint8_t, std::pair<std::uint64_t, std::uint64_t>>> groups_;  // opcode, begin, end
  std::set<std::uint16_t> repeated_schemas_, repeated_channels_;
  // parallel to chunks_, attachments_ and metadata_
  std::vector<bool> indexed_chunks_, indexed_attachments_, indexed_metadata_;

  std::vector<std::string> deviations_;  // the first ones
  std::uint64_t deviation_count_ = 0;
  Place deviation_at_;  // place of the first one
};

}  // namespace rehearse::mcap
