#include <rehearse/cdr.h>
#include <rehearse/ros2msg.h>

#include <array>
#include <charconv>

namespace rehearse::ros2msg {

namespace {

/// One pass over one payload.
class Walk {
 public:
  Walk(const Schema& schema, CdrReader& reader, std::string& path, const std::function<void(const Value&)>& callback)
      : schema_(schema), reader_(reader), path_(path), callback_(callback) {}

  void message(const Definition& definition) {
    // CDR has no empty structures: ROS puts one byte into a message without fields.
    if (definition.fields.empty()) reader_.get<std::uint8_t>();
    for (const FieldDefinition& field : definition.fields) {
      if (!reader_.ok()) return;
      const Segment segment(path_, field.name);
      this->field(field.type);
    }
  }

  bool ok() const { return ok_ && reader_.ok(); }

 private:
  /// Lengthens the path for as long as it lives.
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
    std::uint32_t count = type.count;
    if (type.shape == FieldType::Shape::sequence) {
      count = reader_.get_count(1);
      if (type.count != 0 && count > type.count) ok_ = false;
    }
    if (!ok()) return;
    if (!type.is_message && type.primitive == Primitive::uint8) return blob(count);
    std::array<char, 16> digits;
    for (std::uint32_t i = 0; i < count && ok(); ++i) {
      const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), i).ptr;
      const Segment segment(path_, std::string_view(digits.data(), end));
      element(type);
    }
  }

  void element(const FieldType& type) {
    if (type.is_message) return message(schema_.definitions[type.message]);
    Value value;
    switch (type.primitive) {
      case Primitive::boolean: set_unsigned(value, reader_.get<bool>(), Value::Kind::boolean); break;
      case Primitive::int8: set_signed(value, reader_.get<std::int8_t>()); break;
      case Primitive::int16: set_signed(value, reader_.get<std::int16_t>()); break;
      case Primitive::int32: set_signed(value, reader_.get<std::int32_t>()); break;
      case Primitive::int64: set_signed(value, reader_.get<std::int64_t>()); break;
      case Primitive::uint8: set_unsigned(value, reader_.get<std::uint8_t>()); break;
      case Primitive::uint16: set_unsigned(value, reader_.get<std::uint16_t>()); break;
      case Primitive::uint32: set_unsigned(value, reader_.get<std::uint32_t>()); break;
      case Primitive::uint64: set_unsigned(value, reader_.get<std::uint64_t>()); break;
      case Primitive::float32: value.number = static_cast<double>(reader_.get<float>()); break;
      case Primitive::float64: value.number = reader_.get<double>(); break;
      case Primitive::string:
        value.kind = Value::Kind::text;
        value.text = reader_.get_string();
        if (type.string_bound != 0 && value.text.size() > type.string_bound) ok_ = false;
        break;
    }
    emit(value);
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
    if (!ok()) return;
    value.path = path_;
    callback_(value);
  }

  const Schema& schema_;
  CdrReader& reader_;
  std::string& path_;
  const std::function<void(const Value&)>& callback_;
  bool ok_ = true;
};

}  // namespace

bool Decoder::decode(std::span<const std::byte> payload, const std::function<void(const Value&)>& callback) {
  CdrReader reader(payload);
  path_.clear();
  Walk walk(schema_, reader, path_, callback);
  walk.message(schema_.definitions.front());
  return walk.ok();
}

}  // namespace rehearse::ros2msg
