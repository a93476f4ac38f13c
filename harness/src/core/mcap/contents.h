// The contents of a file, read record by record, and the damage found in them. Internal.
#pragma once

#include "records.h"

namespace rehearse::mcap {

/// The damage found so far: a bounded list, so that a heavily damaged file doesn't fill the memory.
class DamageLog {
 public:
  explicit DamageLog(std::string file) : file_(std::move(file)) {}
  void add(std::string message);
  /// Adds the damage of another log.
  void add(const DamageLog& other);
  /// Adds the damage of the files that were converted to this file.
  void add(const Diagnostics& of_sources);
  const Diagnostics& list() const { return list_; }
  const std::string& file() const { return file_; }

 private:
  static constexpr std::size_t limit = 50;
  std::string file_;
  Diagnostics list_;
};

struct Contents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::optional<Statistics> statistics;

  /// Reads a Schema or Channel record; ignores any other record. Contradictions are added to `damage`.
  void learn(const Record& record, DamageLog& damage);
  void learn_header(const Record& record, DamageLog& damage);
  /// Adds the channels and schemas that are missing here, and replaces the statistics. The addresses of present
  /// channels and schemas stay valid.
  void add(Contents&& others);
  const Schema* schema_of(const Channel& channel) const;
  /// True if every channel's schema is known.
  bool has_all_schemas() const;
  /// The message of a record; its channel is null (and damage logged) if it can't be read.
  Message read_message(const Record& record, DamageLog& damage) const;

 private:
  void learn_schema(const Record& record, DamageLog& damage);
  void learn_channel(const Record& record, DamageLog& damage);
};

/// The attachment of a record; its data refers to the record's. nullopt (and damage logged) if it isn't whole.
std::optional<Attachment> read_attachment(const Record& record, bool check_crc, DamageLog& damage);
/// The metadata of a record; nullopt (and damage logged) if it isn't whole.
std::optional<Metadata> read_metadata(const Record& record, DamageLog& damage);
/// The header of a chunk.
std::optional<ChunkHead> read_chunk_head(const Record& record, DamageLog& damage);

// The frame of a file (its magic bytes, DataEnd and Footer), and the messages if a part of it is wrong.

bool begins_with_magic(Bytes bytes);

/// The reason why a file with this start isn't read; `file`: its name in the message.
Diagnostic not_mcap(std::string file, Bytes start);

/// The place where the records end before DataEnd and Footer.
struct CutPlace {
  std::uint64_t record = 0;      // offset of the first incomplete record
  std::uint64_t size = 0;        // size of the file [bytes]
  bool ends_with_magic = false;  // the file ends with the magic bytes
  bool zeros_only = false;       // all bytes from `record` on are zeros
};
std::string describe_cut(const CutPlace& cut);

bool is_all_zero(Bytes bytes);

/// The CRC that a DataEnd states, if any.
std::optional<std::uint32_t> read_data_end(const Record& record, DamageLog& damage);

/// The Footer, if it states that the summary begins at `summary_start`.
std::optional<Footer> read_footer(const Record& record, std::uint64_t summary_start, DamageLog& damage);

/// The part of the Footer before its CRC, which covers the summary up to there [bytes of the record].
inline constexpr std::size_t footer_covered = record_head + 16;

/// The Footer of a file with a regular end; `at`: its offset.
std::optional<Footer> find_footer(Bytes file, std::uint64_t& at);

/// Checks the bytes after the Footer: `tail` begins at byte `offset`; one byte more than the magic's size is enough.
void check_tail(Bytes tail, std::uint64_t offset, DamageLog& damage);

}  // namespace rehearse::mcap
