// Reads and writes little-endian values in byte ranges: the basic encoding of MCAP records. Internal.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse::mcap {

static_assert(std::endian::native == std::endian::little, "the format is little-endian, and so is this code");

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Appends values to a vector.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  void put(std::integral auto value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    put_bytes({bytes, sizeof value});
  }
  /// A length of four bytes, then the bytes.
  void put(std::span<const std::byte> bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    put_bytes(bytes);
  }
  /// A length of four bytes, then the text.
  void put(std::string_view text) { put(as_bytes(text)); }
  /// A length of four bytes, then all keys and values.
  template <class Key, class Value>
  void put(const std::map<Key, Value>& map) {
    const std::size_t length_at = size();
    put(std::uint32_t{0});
    for (const auto& [key, value] : map) {
      put(key);
      put(value);
    }
    patch(length_at, static_cast<std::uint32_t>(size() - length_at - 4));
  }
  /// The bytes alone.
  void put_bytes(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

  /// Begins a record: opcode, and a length that end_record() fills in.
  void begin_record(std::uint8_t opcode);
  void end_record();
  /// A whole record.
  template <class... Fields>
  void put_record(std::uint8_t opcode, const Fields&... fields) {
    begin_record(opcode);
    (put(fields), ...);
    end_record();
  }

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

  template <std::integral T>
  T get() {
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
  std::string get_string() { return std::string(as_text(get_bytes(get<std::uint32_t>()))); }

  // The same values as the put() of each type writes. Bytes stay in the range.
  template <std::integral T>
  void get(T& value) {
    value = get<T>();
  }
  void get(std::span<const std::byte>& bytes) { bytes = get_bytes(get<std::uint32_t>()); }
  void get(std::string& text) { text = get_string(); }
  template <class Key, class Value>
  void get(std::map<Key, Value>& map) {
    ByteReader entries(get_bytes(get<std::uint32_t>()));
    while (entries.left() > 0) {
      Key key{};
      Value value{};
      entries.get(key);
      entries.get(value);
      if (!entries.ok()) break;
      map.insert_or_assign(std::move(key), std::move(value));
    }
    ok_ = ok_ && entries.ok();
  }

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }
  std::span<const std::byte> rest() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace rehearse::mcap
