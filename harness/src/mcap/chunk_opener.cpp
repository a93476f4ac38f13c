#include "chunk_opener.h"

#include <fmt/format.h>

namespace rehearse::mcap {

Result<Bytes> ChunkOpener::open(const ChunkHead& head, std::uint64_t offset, RawBuffer& buffer) {
  if (head.uncompressed_size > options_.max_chunk_size) {
    return error(fmt::format("damaged: the chunk at byte {} says that it holds {} bytes decompressed; {} is the limit",
                             offset, head.uncompressed_size, options_.max_chunk_size));
  }
  auto records = decompressor_.decompress(head.compression, head.records, head.uncompressed_size, buffer);
  if (!records) {
    return error(fmt::format("damaged: the chunk at byte {} can't be decompressed: {}", offset,
                             records.errors().front().message));
  }
  if (options_.check_crcs && head.uncompressed_crc != 0 && head.uncompressed_crc != crc32(*records)) {
    return error(fmt::format("damaged: the CRC of the chunk at byte {} doesn't match", offset));
  }
  return records;
}

}  // namespace rehearse::mcap
