// The encoding of protobuf: fields of a message with their numbers. Internal.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

namespace rehearse::ros2msg {

/// The numbers that protobuf's descriptors have for types of fields.
enum class ProtobufType : std::uint8_t {
  none,
  float64,
  float32,
  int64,
  uint64,
  int32,
  fixed64,
  fixed32,
  boolean,
  string,
  group,
  message,
  bytes,
  uint32,
  enumeration,
  sfixed32,
  sfixed64,
  sint32,
  sint64,
};

/// A field as it is encoded: its number, and its content.
struct ProtobufField {
  enum class Wire : std::uint8_t { varint = 0, eight_bytes = 1, length = 2, four_bytes = 5 };
  std::uint32_t number = 0;
  Wire wire = Wire::varint;
  std::uint64_t bits = 0;            // of a number
  std::span<const std::byte> bytes;  // of what has a length

  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
};

/// Reads the fields of a message in order.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const std::byte> message) : rest_(message) {}

  /// False after a field that is cut or of an unknown form.
  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }

  /// None: the message ends, or ok() is false.
  std::optional<ProtobufField> next() {
    if (!ok_ || rest_.empty()) return std::nullopt;
    const std::uint64_t tag = varint();
    ProtobufField field;
    field.number = static_cast<std::uint32_t>(tag >> 3);
    field.wire = static_cast<ProtobufField::Wire>(tag & 7);
    switch (field.wire) {
      case ProtobufField::Wire::varint: field.bits = varint(); break;
      case ProtobufField::Wire::eight_bytes: field.bits = fixed<std::uint64_t>(); break;
      case ProtobufField::Wire::four_bytes: field.bits = fixed<std::uint32_t>(); break;
      case ProtobufField::Wire::length: field.bytes = take(varint()); break;
      default: ok_ = false;
    }
    if (tag >> 3 == 0 || tag >> 3 > 0x1fffffff) ok_ = false;
    return ok_ ? std::optional(field) : std::nullopt;
  }

  std::uint64_t varint() {
    std::uint64_t number = 0;
    for (int shift = 0; shift < 70; shift += 7) {
      const auto byte = take(1);
      if (!ok_) return 0;
      const auto bits = std::to_integer<std::uint64_t>(byte[0]);
      if (shift < 64) number |= (bits & 0x7f) << shift;
      if (bits < 0x80) return number;
    }
    ok_ = false;
    return 0;
  }

  template <class Number>
  Number fixed() {
    const auto bytes = take(sizeof(Number));
    Number number = 0;
    if (ok_) std::memcpy(&number, bytes.data(), sizeof(Number));
    return number;
  }

 private:
  std::span<const std::byte> take(std::uint64_t size) {
    if (size > rest_.size()) ok_ = false;
    if (!ok_) return {};
    const auto taken = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return taken;
  }

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace rehearse::ros2msg
