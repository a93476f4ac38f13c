// What stands behind the data section of a file: DataEnd, the summary, the Footer. Internal.
#pragma once

#include "records.h"

namespace rehearse::mcap {

/// Composes it front to back: groups of the summary's records in the order in which they are added.
class SummaryComposer {
 public:
  /// `data_size`: of everything before DataEnd [bytes]; `data_crc`: of the same, or 0. `form` says whether there are
  /// offsets and a CRC.
  SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, const FileForm& form = {});
  /// Whole records of one opcode; nothing if there are none.
  void add_group(std::uint8_t opcode, Bytes records);
  /// Ends the summary. Nothing is added after it.
  Bytes finish();

 private:
  std::uint64_t data_size_;
  FileForm form_;
  std::vector<std::byte> bytes_;
  std::vector<std::byte> offsets_;  // whole records
  std::size_t summary_at_ = 0;      // in bytes_
};

/// Appends a whole MetadataIndex record: `length` of the record at `offset`, its head included.
void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name);

}  // namespace rehearse::mcap
