// What a file's records say of the file, taken in one by one, and the damage that is found there: the same for a mapped
// file and for a stream. Internal.
#pragma once

#include "records.h"

namespace rehearse::mcap {

/// Damage that was found so far: a bounded list, so that a file full of damage doesn't fill the memory with it.
class DamageLog {
 public:
  explicit DamageLog(std::string file) : file_(std::move(file)) {}
  void add(std::string message);
  /// What another log has found.
  void add(const DamageLog& other);
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

  /// Takes in a Schema or Channel record; anything else is ignored. Contradictions go to `damage`.
  void learn(const Record& record, DamageLog& damage);
  void learn_header(const Record& record, DamageLog& damage);
  /// Adds what these have and this hasn't, and takes their statistics. Channels and schemas stay where they are.
  void add(Contents&& others);
  const Schema* schema_of(const Channel& channel) const;
  /// Every channel's schema is known.
  bool has_all_schemas() const;
  /// The message of a record; its channel null (and damage logged) if it can't be had.
  Message read_message(const Record& record, DamageLog& damage) const;

 private:
  void learn_schema(const Record& record, DamageLog& damage);
  void learn_channel(const Record& record, DamageLog& damage);
};

/// The attachment of a record, its data where the record's is; nullopt (and damage logged) if it isn't whole.
std::optional<Attachment> read_attachment(const Record& record, bool check_crc, DamageLog& damage);
/// The same of metadata.
std::optional<Metadata> read_metadata(const Record& record, DamageLog& damage);
/// The head of a chunk.
std::optional<ChunkHead> read_chunk_head(const Record& record, DamageLog& damage);

// What holds a file together: its magic bytes, DataEnd and Footer; and what is said if one of them isn't right.

bool begins_with_magic(Bytes bytes);

/// Why a file that begins so isn't read.
std::string describe_start(Bytes start);

/// Where the records end before DataEnd and Footer came.
struct CutPlace {
  std::uint64_t record = 0;      // offset of what is no whole record
  std::uint64_t size = 0;        // of the file
  bool ends_with_magic = false;  // the file does
  bool zeros_only = false;       // from `record` on
};
std::string describe_cut(const CutPlace& cut);

bool is_all_zero(Bytes bytes);

/// The CRC that a DataEnd states, if it states one.
std::optional<std::uint32_t> read_data_end(const Record& record, DamageLog& damage);

/// The Footer, if it says that the summary begins at `summary_start`, where it does.
std::optional<Footer> read_footer(const Record& record, std::uint64_t summary_start, DamageLog& damage);

/// Before the Footer's CRC, which covers all of the summary up to there [bytes of the record].
inline constexpr std::size_t footer_covered = record_head + 16;

/// The Footer at the end of a file that ends as it should; `at`: its offset.
std::optional<Footer> find_footer(Bytes file, std::uint64_t& at);

/// Looks at what follows the Footer: `tail` begins at byte `offset`, and one byte more than the magic's is enough.
void check_tail(Bytes tail, std::uint64_t offset, DamageLog& damage);

}  // namespace rehearse::mcap
