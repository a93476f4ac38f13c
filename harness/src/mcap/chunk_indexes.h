// The ChunkIndex records of a file that is being written. Internal.
#pragma once

#include <functional>

#include "records.h"
#include "sink.h"

namespace rehearse::mcap {

/// What the summary says of a chunk.
struct ChunkIndexEntry {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t offset = 0;                                              // of the Chunk record in the file
  std::uint64_t length = 0;                                              // of the whole record
  std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;  // channel, and offset in the file
  std::uint64_t message_index_length = 0;                                // of all of them
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

/// Collects them until the summary wants them. An hour with cameras has half a million: so from a certain size on they
/// are forgotten, and in the end made again from the file, whose chunks and message indexes say the same.
class ChunkIndexes {
 public:
  /// `most`: what is held in memory [bytes].
  ChunkIndexes(const Sink& file, std::size_t most) : can_forget_(file.readable()), most_(most) {}

  void add(const ChunkIndexEntry& entry);

  /// All records in their order, piece by piece. `data_size`: of everything before DataEnd [bytes]. Fails if the file
  /// has to be read and can't be.
  Result<void> write(Sink& file, std::uint64_t data_size, const std::function<void(Bytes)>& out);

 private:
  bool can_forget_;
  std::size_t most_;
  std::vector<std::byte> records_;
  bool forgotten_ = false;
};

}  // namespace rehearse::mcap
