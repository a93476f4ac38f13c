#include "report_blobs.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <rehearse/diagnostic.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/compare/report_json.h"

namespace rehearse {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are stored with the bytes that they have in memory");

// Measured with ten seconds of a humanoid: level 6 and samples of 16384 elements make the report 0.3 percent smaller,
// and take twice the time.
constexpr int compression_level = 2;
constexpr std::size_t sample_size = 1 << 11;  // number of elements with which filters are tried

using Bytes = std::vector<std::uint8_t>;

template <class T>
NumberArray numbers(std::string_view type, std::span<const T> elements) {
  NumberArray array{type, sizeof(T), Bytes(elements.size_bytes())};
  if (!elements.empty()) std::memcpy(array.bytes.data(), elements.data(), array.bytes.size());
  return array;
}

enum class Filter { none, columns, exclusive, exclusive_base };
constexpr std::array<std::string_view, 4> filter_names{"none", "columns", "xor", "xor-base"};

/// The elements from `first` on, filtered as if they were the whole array.
Bytes filtered(Filter filter, const NumberArray& array, const NumberArray* base, std::size_t first, std::size_t count) {
  const std::size_t size = array.size;
  const std::uint8_t* from = array.bytes.data() + first * size;
  if (filter == Filter::none) return Bytes(from, from + count * size);
  Bytes to(count * size);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t byte = 0; byte < size; ++byte) {
      std::uint8_t value = from[i * size + byte];
      if (filter == Filter::exclusive && i > 0) value ^= from[(i - 1) * size + byte];
      if (filter == Filter::exclusive_base) value ^= base->bytes[(first + i) * size + byte];
      to[byte * count + i] = value;
    }
  }
  return to;
}

bool is_constant(const NumberArray& array) {
  for (std::size_t i = array.size; i < array.bytes.size(); ++i)
    if (array.bytes[i] != array.bytes[i - array.size]) return false;
  return true;
}

template <class T>
T first_of(const NumberArray& array) {
  T value;
  std::memcpy(&value, array.bytes.data(), sizeof(T));
  return value;
}

/// Null: no number of JSON has these bits.
ReportJson constant_of(const NumberArray& array) {
  constexpr std::int64_t exact = std::int64_t{1} << 53;
  if (array.type == "f64") {
    const double value = first_of<double>(array);
    const bool usual_nan = std::bit_cast<std::uint64_t>(value) == 0x7ff8000000000000;
    return std::isnan(value) && !usual_nan ? ReportJson() : number_json(value);
  }
  if (array.type == "f32") {
    const float value = first_of<float>(array);
    return std::isnan(value) ? ReportJson() : number_json(static_cast<double>(value));
  }
  if (array.type == "i64") {
    const auto value = first_of<std::int64_t>(array);
    return value > -exact && value < exact ? ReportJson(value) : ReportJson(fmt::format("{}", value));
  }
  if (array.type == "u64") {
    const auto value = first_of<std::uint64_t>(array);
    return value < static_cast<std::uint64_t>(exact) ? ReportJson(value) : ReportJson(fmt::format("{}", value));
  }
  if (array.type == "u32") return first_of<std::uint32_t>(array);
  return first_of<std::uint8_t>(array);
}

}  // namespace

NumberArray array_of(std::span<const float> numbers_) { return numbers<float>("f32", numbers_); }
NumberArray array_of(std::span<const std::uint32_t> numbers_) { return numbers<std::uint32_t>("u32", numbers_); }

BlobWriter::BlobWriter(Put put)
    : put_(std::move(put)), compressor_(libdeflate_alloc_compressor(compression_level), &libdeflate_free_compressor) {
  REHEARSE_ASSERT(compressor_ != nullptr, "libdeflate could allocate memory");
}

BlobWriter::~BlobWriter() = default;

Bytes BlobWriter::deflated(ByteSpan bytes) const {
  Bytes packed(libdeflate_zlib_compress_bound(compressor_.get(), bytes.size()));
  packed.resize(libdeflate_zlib_compress(compressor_.get(), bytes.data(), bytes.size(), packed.data(), packed.size()));
  return packed;
}

/// The stored blob with these bytes; null: none yet.
ReportJson& BlobWriter::stored(const Digest& key) { return known_[key]; }

ReportJson BlobWriter::bytes(ByteSpan bytes) {
  const XXH128_hash_t digest = XXH3_128bits(bytes.data(), bytes.size());
  ReportJson& blob = stored({digest.high64, digest.low64});
  if (!blob.is_null()) return blob;
  blob = {{"id", fmt::format("b{}", next_++)}, {"bytes", bytes.size()}, {"coding", "none"}};
  put(blob, bytes);
  return blob;
}

ReportJson BlobWriter::text(std::string_view text) {
  const ByteSpan bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  ReportJson blob{{"id", fmt::format("b{}", next_++)}, {"bytes", bytes.size()}, {"coding", "deflate"}};
  put(blob, deflated(bytes));
  return blob;
}

void BlobWriter::put(const ReportJson& blob, ByteSpan coded) {
  coded_ += coded.size();
  put_(blob["id"], coded);
}

ReportJson BlobWriter::array(const NumberArray& array, const NumberArray* base) {
  REHEARSE_ASSERT(!base || base->bytes.size() == array.bytes.size(), "a base has as many bytes as the array");
  const std::size_t count = array.count();
  if (count == 0) return {{"type", array.type}, {"count", 0}, {"constant", 0}};
  if (is_constant(array)) {
    ReportJson constant = constant_of(array);
    if (!constant.is_null()) return {{"type", array.type}, {"count", count}, {"constant", std::move(constant)}};
  }
  const auto digest_of = [](ByteSpan bytes, std::uint64_t seed) {
    const XXH128_hash_t digest = XXH3_128bits_withSeed(bytes.data(), bytes.size(), seed);
    return Digest{digest.high64, digest.low64};
  };
  const std::uint64_t type_seed = 1 + XXH3_64bits(array.type.data(), array.type.size());
  const Digest alone = digest_of(array.bytes, type_seed);
  if (const ReportJson& known = stored(alone); !known.is_null()) return known;  // independent of its base

  const std::size_t tried = std::min(count, sample_size), first = (count - tried) / 2;
  Filter best = Filter::none;
  std::size_t least = deflated(filtered(best, array, base, first, tried)).size();
  for (const Filter filter : {Filter::columns, Filter::exclusive, Filter::exclusive_base}) {
    if (filter == Filter::exclusive_base && !base) continue;
    const std::size_t size = deflated(filtered(filter, array, base, first, tried)).size();
    if (size >= least) continue;
    least = size;
    best = filter;
  }
  Digest key = alone;
  if (best == Filter::exclusive_base) {  // it can be decoded with that base only
    const Digest of_base = digest_of(base->bytes, type_seed + 1);
    key.first ^= of_base.first;
    key.second ^= of_base.second;
  }
  ReportJson& blob = stored(key);
  if (!blob.is_null()) return blob;
  blob = {{"id", fmt::format("b{}", next_++)},
          {"bytes", array.bytes.size()},
          {"coding", "deflate"},
          {"type", array.type},
          {"count", count},
          {"filter", filter_names[static_cast<std::size_t>(best)]}};
  put(blob, deflated(filtered(best, array, base, 0, count)));
  if (best != Filter::exclusive_base) {  // controllers' inputs end a tick before the state does
    ReportJson& but_the_last =
        stored(digest_of(ByteSpan(array.bytes).first(array.bytes.size() - array.size), type_seed));
    if (but_the_last.is_null()) {
      but_the_last = blob;
      but_the_last["count"] = count - 1;
    }
  }
  return blob;
}

}  // namespace rehearse
