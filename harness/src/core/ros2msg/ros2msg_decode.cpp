#include <rehearse/cdr.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "payload_walk.h"
#include "ros2msg.h"

namespace rehearse::ros2msg {

namespace {

/// A Visitor that only uses the values.
class ValuesOnly final : public Visitor {
 public:
  explicit ValuesOnly(const std::function<void(const Value&)>& callback) : callback_(callback) {}
  void begin_message() override {}
  void end_message() override {}
  void field(std::string_view) override {}
  void begin_array(std::uint32_t) override {}
  void end_array() override {}
  void value(const Value& value) override { callback_(value); }

 private:
  const std::function<void(const Value&)>& callback_;
};

std::string encapsulation_problem(std::span<const std::byte> payload) {
  const int kind = CdrReader::encapsulation_of(payload);
  if (kind < 0)
    return fmt::format("isn't CDR: it has {} bytes, fewer than the four of the encapsulation", payload.size());
  if (kind == 0x02 || kind == 0x03 || (0x08 <= kind && kind <= 0x0b) || (0x12 <= kind && kind <= 0x15)) {
    return fmt::format("is CDR of a kind that ROS messages don't use (encapsulation 0x{:04x}: a type that may change)",
                       kind);
  }
  return fmt::format("isn't CDR: it begins with 0x{:04x}", kind);
}

/// Reads a payload of ROS 1, with the members of CdrReader that Walk needs: numbers without alignment, texts without a
/// zero at the end.
class PackedReader {
 public:
  explicit PackedReader(std::span<const std::byte> payload) : bytes_(payload) {}

  static bool is_version_2() { return false; }
  bool ok() const { return ok_; }
  std::size_t position() const { return position_; }

  template <class T>
  T get() {
    std::array<std::byte, sizeof(T)> bytes{};
    if (const std::byte* place = take(sizeof(T))) std::memcpy(bytes.data(), place, sizeof(T));
    if constexpr (std::is_same_v<T, bool>)
      return bytes[0] != std::byte{0};
    else
      return std::bit_cast<T>(bytes);
  }
  std::string_view get_string() {
    const auto length = get<std::uint32_t>();
    const std::byte* place = take(length);
    return place ? std::string_view(reinterpret_cast<const char*>(place), length) : std::string_view();
  }
  std::uint32_t get_count(std::size_t element_size) {
    const auto count = get<std::uint32_t>();
    if (ok_ && count > (bytes_.size() - position_) / element_size) ok_ = false;
    return ok_ ? count : 0;
  }
  const std::byte* take(std::size_t count) {
    if (count > bytes_.size() - position_) ok_ = false;
    if (!ok_) return nullptr;
    position_ += count;
    return bytes_.data() + position_ - count;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

/// One pass over one payload of CDR or ROS 1. It always ends: each element takes at least a byte, and the parser limits
/// the depth.
template <class Reader>
class Walk : public PayloadWalk {
 public:
  Walk(const Schema& schema, std::span<const std::byte> payload, std::string& path, Visitor& visitor)
      : PayloadWalk(schema, path, visitor), payload_(payload), reader_(payload) {
    if (!reader_.ok()) fail(encapsulation_problem(payload));
  }

  void message(const Definition& definition) {
    visitor_.begin_message();
    if constexpr (std::is_same_v<Reader, CdrReader>) {
      if (definition.fields
              .empty()) {  // CDR has no empty structures: ROS 2 encodes one byte for a message without fields
        reader_.template get<std::uint8_t>();
        check_end();
      }
    }
    for (const FieldDefinition& field : definition.fields) {
      if (!ok()) return;
      const Segment segment(path_, field.name);
      visitor_.field(field.name);
      this->field(field.type);
    }
    if (ok()) visitor_.end_message();
  }

 private:
  void field(const FieldType& type) {
    if (type.shape == FieldType::Shape::single) return element(type);
    std::size_t size = 0;
    const bool has_size = reader_.is_version_2() && (type.is_message || type.primitive == Primitive::string);
    if (has_size) size = reader_.template get<std::uint32_t>();
    const std::size_t begin = reader_.position();
    std::uint32_t count = type.count;
    if (type.shape == FieldType::Shape::sequence) {
      count = reader_.get_count(1);
      if (type.count != 0 && count > type.count)
        fail_at(fmt::format("has {} elements of at most {}", count, type.count));
    }
    check_end();
    if (!ok()) return;
    if (!type.is_message && type.primitive == Primitive::uint8) return blob(count);
    if (type.is_message && std::is_same_v<Reader, PackedReader> && is_empty(type.message)) count = 0;
    array(count, [&](std::uint32_t) { element(type); });
    if (ok() && has_size && reader_.position() - begin != size) {
      fail_at(fmt::format("states {} bytes and has {}", size, reader_.position() - begin));
    }
  }

  void element(const FieldType& type) {
    if (type.is_message) return message(schema_.definitions[type.message]);
    Value value;
    switch (type.primitive) {
      case Primitive::boolean: set_unsigned(value, take<bool>(value), Value::Kind::boolean); break;
      case Primitive::int8: set_signed(value, take<std::int8_t>(value)); break;
      case Primitive::int16: set_signed(value, take<std::int16_t>(value)); break;
      case Primitive::int32: set_signed(value, take<std::int32_t>(value)); break;
      case Primitive::int64: set_signed(value, take<std::int64_t>(value)); break;
      case Primitive::uint8: set_unsigned(value, take<std::uint8_t>(value)); break;
      case Primitive::uint16: set_unsigned(value, take<std::uint16_t>(value)); break;
      case Primitive::uint32: set_unsigned(value, take<std::uint32_t>(value)); break;
      case Primitive::uint64: set_unsigned(value, take<std::uint64_t>(value)); break;
      case Primitive::float32: value.number = static_cast<double>(take<float>(value)); break;
      case Primitive::float64: value.number = take<double>(value); break;
      case Primitive::string:
        set_text(value, reader_.get_string());
        if (type.string_bound != 0 && value.text.size() > type.string_bound) {
          fail_at(fmt::format("has {} characters of at most {}", value.text.size(), type.string_bound));
        }
        break;
    }
    emit_read(value);
  }

  /// True if a message takes no byte in ROS 1: then no count of them is too large for a payload.
  bool is_empty(std::size_t message) const {
    return std::ranges::all_of(schema_.definitions[message].fields, [this](const FieldDefinition& field) {
      return field.type.is_message && field.type.shape != FieldType::Shape::sequence && is_empty(field.type.message);
    });
  }

  /// Reads a number, and its bytes in the payload.
  template <class Number>
  Number take(Value& value) {
    const Number number = reader_.template get<Number>();
    if (reader_.ok()) value.bytes = payload_.subspan(reader_.position() - sizeof(Number), sizeof(Number));
    return number;
  }

  void blob(std::uint32_t count) {
    Value value;
    set_blob(value, {});
    const std::byte* place = reader_.take(count);
    if (place != nullptr) value.blob = {place, count};
    emit_read(value);
  }

  void emit_read(Value& value) {
    check_end();
    emit(value);
  }

  void check_end() {
    if (reader_.ok()) return;
    fail(fmt::format("ends at byte {}{}{}", reader_.position(), path_.empty() ? "" : ", within ", path_));
  }
  void fail_at(std::string_view what) { fail(fmt::format("breaks its schema: {} {}", path_, what)); }

  const std::span<const std::byte> payload_;
  Reader reader_;
};

template <class Reader>
std::string walk(const Schema& schema, std::span<const std::byte> payload, std::string& path, Visitor& visitor) {
  Walk<Reader> walk(schema, payload, path, visitor);
  if (walk.ok()) walk.message(schema.definitions.front());
  return walk.take_problem();
}

}  // namespace

bool Decoder::decode(std::span<const std::byte> payload, const std::function<void(const Value&)>& callback) {
  ValuesOnly visitor(callback);
  return decode(payload, visitor);
}

bool Decoder::decode(std::span<const std::byte> payload, Visitor& visitor) {
  path_.clear();
  switch (schema_.encoding) {
    case Encoding::cdr: problem_ = walk<CdrReader>(schema_, payload, path_, visitor); break;
    case Encoding::ros1: problem_ = walk<PackedReader>(schema_, payload, path_, visitor); break;
    case Encoding::json: problem_ = walk_json(schema_, payload, path_, visitor); break;
    case Encoding::protobuf: problem_ = walk_protobuf(schema_, payload, path_, visitor); break;
  }
  return problem_.empty();
}

}  // namespace rehearse::ros2msg
