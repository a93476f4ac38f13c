// Where records go on behind damage. Internal.
//
// Records have no marks to be found by, so a place is believed for what stands there:
// - a chunk or attachment with a CRC: if it matches. Nothing else has one.
// - any other record: if its fields come to exactly its length, its texts are UTF-8, and the same is true of the two
//   records behind it, or of those up to the file's end.
// - a message: only where the file has had messages outside of chunks before. Those inside of a chunk whose head is
//   lost look alike, and nothing says that they are right.
#pragma once

#include "chunks.h"

namespace rehearse::mcap {

class Resync {
 public:
  Resync(Bytes file, std::uint64_t max_chunk_size);

  /// From now on messages outside of chunks are believed.
  void expect_loose_messages() { loose_messages_ = true; }

  /// The first record from `begin` on that is believed; nullopt: there is none.
  std::optional<std::uint64_t> find(std::uint64_t begin);

  /// True if a record, or the file's end, can be there: whatever stands before it has the length that it says.
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
  std::uint64_t budget_;  // for places that turn out to be none [bytes]: hostile files don't make this quadratic
  ChunkOpener opener_;
  RawBuffer buffer_;
};

}  // namespace rehearse::mcap
