// CRC32 and the two compressions of MCAP chunks. Internal; only this file uses zstd, lz4 and libdeflate.
#pragma once

#include <rehearse/mcap.h>

#include <functional>
#include <memory>

namespace rehearse::mcap {

/// CRC32 as in zlib; `seed` continues an earlier one.
std::uint32_t crc32(Bytes bytes, std::uint32_t seed = 0);

/// Compresses chunks one after the other; the state is reused.
class Compressor {
 public:
  Compressor(int zstd_level, int lz4_level);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  /// The compressed bytes; valid until the next call. With Compression::none: the input itself.
  Result<Bytes> compress(Compression compression, Bytes raw);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A buffer whose memory isn't touched before it is written: a false length in a hostile file costs only address space.
class RawBuffer {
 public:
  std::byte* reserve(std::size_t size) {
    if (size > capacity_) {
      data_ = std::make_unique_for_overwrite<std::byte[]>(size);
      capacity_ = size;
    }
    return data_.get();
  }

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t capacity_ = 0;
};

/// Decompresses all zstd frames of a file, piece by piece, until `take` returns false. Fails, after all pieces that can
/// be decompressed, if the bytes are damaged or cut.
Result<void> decompress_frames(Bytes compressed, const std::function<bool(Bytes)>& take);

class Decompressor {
 public:
  Decompressor();
  ~Decompressor();
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;

  /// Decompresses into `out`; the result must have exactly `size` bytes. `compression` is the name in the chunk; for an
  /// empty name it returns `compressed` itself. The diagnostic states the problem, not the place.
  Result<Bytes> decompress(std::string_view compression, Bytes compressed, std::uint64_t size, RawBuffer& out);

  /// Decompresses one zstd frame of a size that the frame states, at most `most` bytes.
  Result<Bytes> decompress_frame(Bytes compressed, std::uint64_t most, RawBuffer& out);

  /// Decompresses damaged bytes as far as possible, at most `size` bytes; returns nothing for an unknown compression.
  Bytes decompress_front(std::string_view compression, Bytes compressed, std::uint64_t size, RawBuffer& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rehearse::mcap
