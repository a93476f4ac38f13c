// From a chunk to the records in it, and which channels share chunks. Internal.
#pragma once

#include "codec.h"
#include "records.h"

namespace rehearse::mcap {

/// A chunk's records, or why they can't be had.
struct OpenedChunk {
  enum class Fault { none, too_short, too_large, not_decompressed, wrong_crc } fault = Fault::none;
  std::uint64_t offset = 0;  // of the chunk in the file
  ChunkHead head;            // unless it is too short
  Bytes records;             // decompressed; in the buffer, or where the chunk itself is
  std::string reason;        // for which it can't be decompressed

  bool ok() const { return fault == Fault::none; }
};

class ChunkOpener {
 public:
  explicit ChunkOpener(const ReaderOptions& options) : options_(options) {}

  /// Opens the chunk of a record, its size limited and its CRC checked as the options say.
  OpenedChunk open(const Record& chunk, RawBuffer& buffer);
  /// The records at the front of a damaged or cut chunk, as far as they can be decompressed.
  Bytes open_front(const ChunkHead& head, RawBuffer& buffer);
  /// What a reader says of a chunk that isn't ok.
  std::string describe(const OpenedChunk& chunk) const;

 private:
  ReaderOptions options_;
  Decompressor decompressor_;
};

/// Which channels share chunks in a file, so that a copy keeps pictures apart from numbers as the file did.
class ChannelGroups {
 public:
  /// A chunk with messages of these channels.
  void add_chunk(std::string_view compression, std::span<const std::uint16_t> channels);
  /// A chunk with messages of nobody knows which channels: how those are compressed that no other chunk is added for.
  void add_chunk(std::string_view compression);
  ChunkGroup of(std::uint16_t channel) const;

 private:
  std::uint16_t root_of(std::uint16_t channel) const;
  std::map<std::uint16_t, std::uint16_t> parent_;     // of each channel; a root's is itself
  std::map<std::uint16_t, Compression> compression_;  // by root
  Compression otherwise_ = Compression::zstd;
};

/// Of a file, from its message indexes; nothing is decompressed. A chunk without an index tells only how it is
/// compressed: that goes for all channels without one.
ChannelGroups groups_of(Bytes file);

}  // namespace rehearse::mcap
