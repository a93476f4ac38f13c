// Reads the records of a chunk, and finds the channels that share chunks. Internal.
#pragma once

#include "codec.h"
#include "file_view.h"
#include "records.h"

#include <string>

namespace rehearse::mcap {

/// The records of a chunk, or the reason why they can't be read.
struct OpenedChunk {
  enum class Fault { none, too_short, too_large, not_decompressed, wrong_crc } fault = Fault::none;
  std::uint64_t offset = 0;  // offset of the chunk in the file
  ChunkHead head;            // valid unless the chunk is too short
  Bytes records;             // decompressed records, in the buffer or in the chunk itself
  std::string reason;        // why the records can't be decompressed

  bool ok() const { return fault == Fault::none; }
};

class ChunkOpener {
 public:
  explicit ChunkOpener(const ReaderOptions& options) : options_(options) {}

  /// Opens the chunk of a record; limits its size and checks its CRC as the options state.
  OpenedChunk open(const Record& chunk, RawBuffer& buffer);
  /// The records at the front of a damaged or cut chunk, as far as they can be decompressed.
  Bytes open_front(const ChunkHead& head, RawBuffer& buffer);
  /// The damage of a chunk that isn't ok, as text.
  std::string describe(const OpenedChunk& chunk) const;

 private:
  ReaderOptions options_;
  Decompressor decompressor_;
};

/// The channels that share chunks in a file, so that a copy separates pictures from numbers as the file did.
class ChannelGroups {
 public:
  /// Adds a chunk with messages of these channels.
  void add_chunk(std::string_view compression, std::span<const std::uint16_t> channels);
  /// Adds a chunk with messages of unknown channels. Its compression is used for all channels without another chunk.
  void add_chunk(std::string_view compression);
  ChunkGroup of(std::uint16_t channel) const;

  std::uint64_t private_records = 0;  // number of records outside of chunks that no copy contains

 private:
  std::uint16_t root_of(std::uint16_t channel) const;
  std::map<std::uint16_t, std::uint16_t> parent_;     // parent of each channel; a root is its own parent
  std::map<std::uint16_t, Compression> compression_;  // compression of each root
  Compression otherwise_ = Compression::zstd;
};

/// A sentence about the private records that a copy lacks; empty: there are none.
std::string private_remark(const ChannelGroups& groups, const std::string& file);

/// The groups of a file, from its message indexes; nothing is decompressed. A chunk without an index only determines
/// the compression of all channels without one. `file`: the view's bytes, whose memory is released, or bytes of another
/// source.
ChannelGroups groups_of(const FileView& view, Bytes file);

}  // namespace rehearse::mcap
