// From a chunk to the records in it. Internal.
#pragma once

#include "codec.h"
#include "records.h"

namespace rehearse::mcap {

class ChunkOpener {
 public:
  explicit ChunkOpener(const ReaderOptions& options) : options_(options) {}

  /// The chunk's decompressed records, its CRC checked; in `buffer`, or where the chunk itself is. The diagnostic says
  /// which chunk of the file, not which file.
  Result<Bytes> open(const ChunkHead& head, std::uint64_t offset, RawBuffer& buffer);

 private:
  ReaderOptions options_;
  Decompressor decompressor_;
};

}  // namespace rehearse::mcap
