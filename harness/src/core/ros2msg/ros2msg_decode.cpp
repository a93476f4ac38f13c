#include <rehearse/cdr.h>

#include <fmt/format.h>

#include <array>
#include <charconv>

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

/// One pass over one payload. It always ends: each element takes at least a byte, and the parser limits the depth.
class Walk {
 public:
  Walk(const Schema& schema, std::span<const std::byte> payload, std::string& path, Visitor& visitor)
      : schema_(schema), payload_(payload), reader_(payload), path_(path), visitor_(visitor) {
    if (!reader_.ok()) problem_ = encapsulation_problem(payload);
  }

  void message(const Definition& definition) {
    visitor_.begin_message();
    if (definition.fields.empty()) {  // CDR has no empty structures: ROS encodes one byte for a message without fields
      reader_.get<std::uint8_t>();
      check_end();
    }
    for (const FieldDefinition& field : definition.fields) {
      if (!ok()) return;
      const Segment segment(path_, field.name);
      visitor_.field(field.name);
      this->field(field.type);
    }
    if (ok()) visitor_.end_message();
  }

  bool ok() const { return problem_.empty(); }
  std::string take_problem() { return std::move(problem_); }

 private:
  /// Extends the path during its lifetime.
  class Segment {
   public:
    Segment(std::string& path, std::string_view name) : path_(path), length_(path.size()) {
      if (!path_.empty()) path_ += '/';
      path_ += name;
    }
    ~Segment() { path_.resize(length_); }
    Segment(const Segment&) = delete;
    Segment& operator=(const Segment&) = delete;

   private:
    std::string& path_;
    std::size_t length_;
  };

  void field(const FieldType& type) {
    if (type.shape == FieldType::Shape::single) return element(type);
    std::size_t size = 0;
    const bool has_size = reader_.is_version_2() && (type.is_message || type.primitive == Primitive::string);
    if (has_size) size = reader_.get<std::uint32_t>();
    const std::size_t begin = reader_.position();
    std::uint32_t count = type.count;
    if (type.shape == FieldType::Shape::sequence) {
      count = reader_.get_count(1);
      if (type.count != 0 && count > type.count) fail(fmt::format("has {} elements of at most {}", count, type.count));
    }
    check_end();
    if (!ok()) return;
    if (!type.is_message && type.primitive == Primitive::uint8) return blob(count);
    elements(type, count);
    if (ok() && has_size && reader_.position() - begin != size) {
      fail(fmt::format("states {} bytes and has {}", size, reader_.position() - begin));
    }
  }

  void elements(const FieldType& type, std::uint32_t count) {
    visitor_.begin_array(count);
    std::array<char, 16> digits;
    for (std::uint32_t i = 0; i < count && ok(); ++i) {
      const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), i).ptr;
      const Segment segment(path_, std::string_view(digits.data(), end));
      element(type);
    }
    if (ok()) visitor_.end_array();
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
        value.kind = Value::Kind::text;
        value.text = reader_.get_string();
        if (type.string_bound != 0 && value.text.size() > type.string_bound) {
          fail(fmt::format("has {} characters of at most {}", value.text.size(), type.string_bound));
        }
        break;
    }
    emit(value);
  }

  /// Reads a number, and its bytes in the payload.
  template <class Number>
  Number take(Value& value) {
    const Number number = reader_.get<Number>();
    if (reader_.ok()) value.bytes = payload_.subspan(reader_.position() - sizeof(Number), sizeof(Number));
    return number;
  }

  void blob(std::uint32_t count) {
    Value value;
    value.kind = Value::Kind::blob;
    const std::byte* place = reader_.take(count);
    if (place != nullptr) value.blob = {place, count};
    emit(value);
  }

  static void set_signed(Value& value, std::int64_t number) {
    value.kind = Value::Kind::signed_integer;
    value.integer = number;
  }
  static void set_unsigned(Value& value, std::uint64_t number, Value::Kind kind = Value::Kind::unsigned_integer) {
    value.kind = kind;
    value.unsigned_integer = number;
  }

  void emit(Value& value) {
    check_end();
    if (!ok()) return;
    value.path = path_;
    visitor_.value(value);
  }

  void check_end() {
    if (reader_.ok() || !ok()) return;
    problem_ = fmt::format("ends at byte {}{}{}", reader_.position(), path_.empty() ? "" : ", within ", path_);
  }
  void fail(std::string_view what) {
    if (ok()) problem_ = fmt::format("breaks its schema: {} {}", path_, what);
  }

  const Schema& schema_;
  const std::span<const std::byte> payload_;
  CdrReader reader_;
  std::string& path_;
  Visitor& visitor_;
  std::string problem_;
};

}  // namespace

bool Decoder::decode(std::span<const std::byte> payload, const std::function<void(const Value&)>& callback) {
  ValuesOnly visitor(callback);
  return decode(payload, visitor);
}

bool Decoder::decode(std::span<const std::byte> payload, Visitor& visitor) {
  path_.clear();
  Walk walk(schema_, payload, path_, visitor);
  if (walk.ok()) walk.message(schema_.definitions.front());
  problem_ = walk.take_problem();
  return problem_.empty();
}

}  // namespace rehearse::ros2msg
