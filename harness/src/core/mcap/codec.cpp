#include "codec.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>

#include "base/text.h"

namespace rehearse::mcap {

std::uint32_t crc32(Bytes bytes, std::uint32_t seed) {
  if (bytes.empty()) return seed;  // for libdeflate a null pointer means a new checksum
  return libdeflate_crc32(seed, bytes.data(), bytes.size());
}

std::string_view to_string(Compression compression) {
  switch (compression) {
    case Compression::none: return "";
    case Compression::lz4: return "lz4";
    case Compression::zstd: return "zstd";
  }
  REHEARSE_ASSERT(false, "the value is no Compression");
}

struct Compressor::State {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  LZ4F_preferences_t lz4 = LZ4F_INIT_PREFERENCES;
  RawBuffer out;
};

Compressor::Compressor(int zstd_level, int lz4_level) : state_(std::make_unique<State>()) {
  state_->lz4.compressionLevel = lz4_level;
  ZSTD_CCtx_setParameter(state_->zstd.get(), ZSTD_c_compressionLevel, zstd_level);
}

Compressor::~Compressor() = default;

Result<Bytes> Compressor::compress(Compression compression, Bytes raw) {
  if (compression == Compression::none) return raw;
  const bool zstd = compression == Compression::zstd;
  const std::size_t bound = zstd ? ZSTD_compressBound(raw.size()) : LZ4F_compressFrameBound(raw.size(), &state_->lz4);
  std::byte* out = state_->out.reserve(bound);
  const std::size_t size = zstd ? ZSTD_compress2(state_->zstd.get(), out, bound, raw.data(), raw.size())
                                : LZ4F_compressFrame(out, bound, raw.data(), raw.size(), &state_->lz4);
  if (zstd ? ZSTD_isError(size) : LZ4F_isError(size)) {
    return error(fmt::format("{} can't compress a chunk: {}", to_string(compression),
                             zstd ? ZSTD_getErrorName(size) : LZ4F_getErrorName(size)));
  }
  return Bytes(out, size);
}

namespace {
LZ4F_dctx* create_lz4_context() {
  LZ4F_dctx* context = nullptr;
  const auto status = LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  REHEARSE_ASSERT(!LZ4F_isError(status), "lz4 has no memory for a context");
  return context;
}
}  // namespace

/// Of both formats, made when they are needed: most files have one at most, and their memory is large.
struct Decompressor::State {
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> zstd{nullptr, &ZSTD_freeDCtx};
  std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> lz4{nullptr, &LZ4F_freeDecompressionContext};

  ZSTD_DCtx* for_zstd() {
    if (!zstd) zstd.reset(ZSTD_createDCtx());
    return zstd.get();
  }
  LZ4F_dctx* for_lz4() {
    if (!lz4) lz4.reset(create_lz4_context());
    return lz4.get();
  }
};

Decompressor::Decompressor() : state_(std::make_unique<State>()) {}

Decompressor::~Decompressor() = default;

namespace {

Diagnostic wrong_size(std::uint64_t said, std::uint64_t found) {
  return error(fmt::format("it states {} bytes decompressed and contains {}", said, found));
}

Result<Bytes> decompress_zstd(ZSTD_DCtx* context, Bytes compressed, std::uint64_t size, RawBuffer& out) {
  std::byte* target = out.reserve(size);
  const std::size_t got = ZSTD_decompressDCtx(context, target, size, compressed.data(), compressed.size());
  if (ZSTD_isError(got)) return error(fmt::format("zstd reports: {}", ZSTD_getErrorName(got)));
  if (got != size) return wrong_size(size, got);
  return Bytes(target, size);
}

Result<Bytes> decompress_lz4(LZ4F_dctx* context, Bytes compressed, std::uint64_t size, RawBuffer& out) {
  LZ4F_resetDecompressionContext(context);
  std::byte* target = out.reserve(size);
  std::size_t written = 0;
  std::size_t read = 0;
  std::size_t wanted = 1;
  while (wanted != 0) {
    std::size_t room = size - written;
    std::size_t taken = compressed.size() - read;
    wanted = LZ4F_decompress(context, target + written, &room, compressed.data() + read, &taken, nullptr);
    if (LZ4F_isError(wanted)) return error(fmt::format("lz4 reports: {}", LZ4F_getErrorName(wanted)));
    written += room;
    read += taken;
    if (wanted != 0 && room == 0 && taken == 0) return error("its lz4 frame doesn't end at the stated size");
  }
  if (written != size || read != compressed.size()) return wrong_size(size, written);
  return Bytes(target, size);
}

}  // namespace

Result<Bytes> Decompressor::decompress(std::string_view compression, Bytes compressed, std::uint64_t size,
                                       RawBuffer& out) {
  if (compression.empty()) {
    if (compressed.size() != size) return wrong_size(size, compressed.size());
    return compressed;
  }
  if (compression == "zstd") return decompress_zstd(state_->for_zstd(), compressed, size, out);
  if (compression == "lz4") return decompress_lz4(state_->for_lz4(), compressed, size, out);
  return error(fmt::format("its compression \"{}\" isn't one of zstd, lz4 and none", printable(compression)));
}

Result<Bytes> Decompressor::decompress_frame(Bytes compressed, std::uint64_t most, RawBuffer& out) {
  const std::uint64_t size = ZSTD_getFrameContentSize(compressed.data(), compressed.size());
  if (size > most) return error("its zstd frame states no size, or one that is too large");
  return decompress_zstd(state_->for_zstd(), compressed, size, out);
}

Result<void> decompress_frames(Bytes compressed, const std::function<bool(Bytes)>& take) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  std::vector<std::byte> piece(ZSTD_DStreamOutSize());
  ZSTD_inBuffer in{compressed.data(), compressed.size(), 0};
  std::size_t wanted = 1;
  bool is_full = false;
  while (in.pos < in.size || is_full) {
    ZSTD_outBuffer out{piece.data(), piece.size(), 0};
    wanted = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(wanted))
      return error(fmt::format("damaged at byte {}: zstd reports: {}", in.pos, ZSTD_getErrorName(wanted)));
    if (out.pos > 0 && !take(Bytes(piece).first(out.pos))) return {};
    is_full = out.pos == out.size;
  }
  if (wanted != 0) return error(fmt::format("truncated at byte {}: its zstd frame isn't whole", in.size));
  return {};
}

namespace {

/// The number of bytes of `target` that could be filled before the stream ended or was invalid.
std::size_t front_of_zstd(ZSTD_DCtx* context, Bytes compressed, std::byte* target, std::size_t size) {
  ZSTD_DCtx_reset(context, ZSTD_reset_session_only);
  ZSTD_inBuffer in{compressed.data(), compressed.size(), 0};
  ZSTD_outBuffer out{target, size, 0};
  while (out.pos < size) {
    const std::size_t before = in.pos + out.pos;
    const std::size_t wanted = ZSTD_decompressStream(context, &out, &in);
    if (ZSTD_isError(wanted) || wanted == 0 || in.pos + out.pos == before) break;
  }
  return out.pos;
}

std::size_t front_of_lz4(LZ4F_dctx* context, Bytes compressed, std::byte* target, std::size_t size) {
  LZ4F_resetDecompressionContext(context);
  std::size_t written = 0;
  std::size_t read = 0;
  while (written < size) {
    std::size_t room = size - written;
    std::size_t taken = compressed.size() - read;
    const std::size_t wanted =
        LZ4F_decompress(context, target + written, &room, compressed.data() + read, &taken, nullptr);
    if (LZ4F_isError(wanted)) break;
    written += room;
    read += taken;
    if (wanted == 0 || room + taken == 0) break;
  }
  return written;
}

}  // namespace

Bytes Decompressor::decompress_front(std::string_view compression, Bytes compressed, std::uint64_t size,
                                     RawBuffer& out) {
  if (compression.empty()) return compressed.first(std::min<std::uint64_t>(size, compressed.size()));
  if (compression != "zstd" && compression != "lz4") return {};
  std::byte* target = out.reserve(size);
  const std::size_t got = compression == "zstd" ? front_of_zstd(state_->for_zstd(), compressed, target, size)
                                                : front_of_lz4(state_->for_lz4(), compressed, target, size);
  return Bytes(target, got);
}

}  // namespace rehearse::mcap
