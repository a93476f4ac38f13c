// Encodes numbers and bytes as described in tools/report/FORMAT.md. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct libdeflate_compressor;

namespace rehearse {

using ReportJson = nlohmann::ordered_json;
using ByteSpan = std::span<const std::uint8_t>;

/// An array of numbers: contiguous elements of `size` bytes, little-endian.
struct NumberArray {
  std::string_view type;  // "f64", "f32", "i64", "u64", "u32", "u8"
  std::size_t size = 8;   // of an element [bytes]
  std::vector<std::uint8_t> bytes;

  std::size_t count() const { return bytes.size() / size; }
};

NumberArray array_of(std::span<const float> numbers);
NumberArray array_of(std::span<const std::uint32_t> numbers);

/// Packs blobs, and passes them on one by one. Equal bytes get the same blob.
class BlobWriter {
 public:
  using Put = std::function<void(const std::string& id, ByteSpan coded)>;
  explicit BlobWriter(Put put);
  ~BlobWriter();
  BlobWriter(const BlobWriter&) = delete;
  BlobWriter& operator=(const BlobWriter&) = delete;

  /// Adds bytes that are compressed already.
  ReportJson bytes(ByteSpan bytes);
  /// Adds an array with the filter that makes it smallest, found by trying. `base`: an array with equal number and size
  /// of elements, which the page has decoded before this one; null: none.
  ReportJson array(const NumberArray& array, const NumberArray* base = nullptr);
  /// Adds a text (UTF-8).
  ReportJson text(std::string_view text);
  /// The size of all blobs so far [bytes].
  std::uint64_t coded() const { return coded_; }

 private:
  using Digest = std::pair<std::uint64_t, std::uint64_t>;
  std::vector<std::uint8_t> deflated(ByteSpan bytes) const;
  ReportJson& stored(const Digest& key);
  void put(const ReportJson& blob, ByteSpan coded);

  Put put_;
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
  std::map<Digest, ReportJson> known_;
  std::size_t next_ = 0;
  std::uint64_t coded_ = 0;
};

}  // namespace rehearse
