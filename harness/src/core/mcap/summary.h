// The end of a written file: DataEnd, the summary, the Footer. Internal.
#pragma once

#include <functional>

#include "records.h"
#include "sink.h"

namespace rehearse::mcap {

/// Composes this end from front to back: groups of the summary's records in the order in which they are added.
class SummaryComposer {
 public:
  using Write = std::function<void(Bytes)>;

  /// `data_size`: number of bytes before DataEnd; `data_crc`: their CRC, or 0. `write` gets the bytes in order.
  SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, Write write);
  /// Adds whole records of one opcode; no effect if there are none.
  void add_group(std::uint8_t opcode, Bytes records);
  /// Adds a group piece by piece: `put_all` passes the pieces to its argument.
  void add_group(std::uint8_t opcode, const std::function<void(const Write&)>& put_all);
  /// Ends the summary. Nothing may be added after it.
  void finish();

 private:
  void put(Bytes bytes);

  const Write write_;
  std::uint64_t start_ = 0;         // offset of the summary in the file
  std::uint64_t offset_;            // offset of the next byte
  std::uint32_t crc_ = 0;           // CRC of the summary so far
  std::vector<std::byte> offsets_;  // whole SummaryOffset records
};

/// Collects the ChunkIndex records of a file for the summary. An hour with cameras has half a million. So above a
/// certain size they are dropped. At the end they are made again from the file's chunks and message indexes, which
/// contain the same data.
class ChunkIndexes {
 public:
  /// `most`: limit of the memory [bytes].
  ChunkIndexes(const Sink& file, std::size_t most) : can_forget_(file.readable()), most_(most) {}

  void add(const ChunkIndex& index);

  /// All records in their order, piece by piece. `data_size`: number of bytes before DataEnd. Fails if the file must be
  /// read and can't be.
  Result<void> write(Sink& file, std::uint64_t data_size, const std::function<void(Bytes)>& out);

 private:
  bool can_forget_;
  std::size_t most_;
  std::vector<std::byte> records_;
  bool forgotten_ = false;
};

}  // namespace rehearse::mcap
