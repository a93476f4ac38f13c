// Reads and writes little-endian values in byte ranges: the basic encoding of MCAP records. Internal.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace rehearse::mcap {

static_assert(std::endian::native == std::endian::little, "the format is little-endian, and so is this code");

/// Appends values to a vector.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  template <class T>
  void put(T value) {
    static_assert(std::is_integral_v<T>);
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    out_.insert(out_.end(), bytes, bytes + sizeof(T));
  }
  void put_bytes(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  void put_string(std::string_view text);  // a length of four bytes, then the text
  void put_map(const std::map<std::string, std::string>& map);

  /// Begins a record: opcode, and a length that end_record() fills in.
  void begin_record(std::uint8_t opcode);
  void end_record();

  /// Overwrites a value that was written at this position before.
  template <class T>
  void patch(std::size_t position, T value) {
    std::memcpy(out_.data() + position, &value, sizeof(T));
  }
  std::size_t size() const { return out_.size(); }

 private:
  std::vector<std::byte>& out_;
  std::size_t record_ = 0;
};

/// Reads values from the front of a range. After the first value that doesn't fit, ok() is false and all values are 0
/// or empty.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    static_assert(std::is_integral_v<T>);
    T value{};
    if (const auto taken = get_bytes(sizeof(T)); !taken.empty()) std::memcpy(&value, taken.data(), sizeof(T));
    return value;
  }
  std::span<const std::byte> get_bytes(std::uint64_t count) {
    if (count > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::string get_string();  // a length of four bytes, then the text
  std::map<std::string, std::string> get_map();

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }
  std::span<const std::byte> rest() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace rehearse::mcap
