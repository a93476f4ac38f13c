// What stands behind the data section of a file that is written: DataEnd, the summary, the Footer. Internal.
#pragma once

#include <functional>

#include "records.h"
#include "sink.h"

namespace rehearse::mcap {

/// Composes it front to back: groups of the summary's records in the order in which they are added.
class SummaryComposer {
 public:
  using Write = std::function<void(Bytes)>;

  /// `data_size`: of everything before DataEnd [bytes]; `data_crc`: of the same, or 0. `form` says whether there are
  /// offsets and a CRC. `write` gets the bytes as they come.
  SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, const FileForm& form, Write write);
  /// Whole records of one opcode; nothing if there are none.
  void add_group(std::uint8_t opcode, Bytes records);
  /// The same piece by piece: `put_all` hands them to what it is given.
  void add_group(std::uint8_t opcode, const std::function<void(const Write&)>& put_all);
  /// Ends the summary. Nothing is added after it.
  void finish();

 private:
  void put(Bytes bytes);

  const FileForm form_;
  const Write write_;
  std::uint64_t start_ = 0;         // of the summary in the file
  std::uint64_t offset_;            // of what comes next
  std::uint32_t crc_ = 0;           // of the summary so far
  std::vector<std::byte> offsets_;  // whole records
};

/// Collects the ChunkIndex records of a file until the summary wants them. An hour with cameras has half a million: so
/// from a certain size on they are forgotten, and in the end made again from the file, whose chunks and message indexes
/// say the same.
class ChunkIndexes {
 public:
  /// `most`: what is held in memory [bytes].
  ChunkIndexes(const Sink& file, std::size_t most) : can_forget_(file.readable()), most_(most) {}

  void add(const ChunkIndex& index);

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
