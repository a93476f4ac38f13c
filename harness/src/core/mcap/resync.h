// Finds the next record after damage. Internal.
//
// Records have no marks to search for, so a place is accepted by its content:
// - a chunk or attachment with a CRC: if the CRC matches. No other record has one.
// - any other record: if its fields have exactly its length, its texts are UTF-8, and the same is true of the next two
//   records, or of those up to the file's end.
// - a message: only if the file had messages outside of chunks before. Messages of a chunk whose header is lost look
//   equal, and nothing confirms that they are right.
#pragma once

#include "chunks.h"

namespace rehearse::mcap {

class Resync {
 public:
  Resync(Bytes file, std::uint64_t max_chunk_size);

  /// From now on messages outside of chunks are accepted.
  void expect_loose_messages() { loose_messages_ = true; }

  /// Offset of the first accepted record from `begin` on; nullopt: there is none.
  std::optional<std::uint64_t> find(std::uint64_t begin);

  /// True if a record, or the file's end, can be at this offset: then the record before it has the right length.
  bool is_plausible(std::uint64_t offset);

 private:
  bool is_believed(std::uint64_t offset);
  bool is_believed_chunk(const Record& chunk);
  bool is_believed_attachment(Bytes body);
  bool leads_on(std::uint64_t offset, int records);
  std::optional<Record> head_at(std::uint64_t offset) const;

  Bytes file_;
  std::uint64_t max_chunk_size_;
  bool loose_messages_ = false;
  std::uint64_t budget_;  // for rejected places [bytes]: it prevents quadratic time in hostile files
  ChunkOpener opener_;
  RawBuffer buffer_;
};

}  // namespace rehearse::mcap
