#include <fmt/format.h>

#include <bit>
#include <vector>

#include "payload_walk.h"
#include "protobuf_wire.h"

namespace rehearse::ros2msg {
namespace {

using Wire = ProtobufField::Wire;

Wire wire_of(ProtobufType type) {
  switch (type) {
    case ProtobufType::float64:
    case ProtobufType::fixed64:
    case ProtobufType::sfixed64: return Wire::eight_bytes;
    case ProtobufType::float32:
    case ProtobufType::fixed32:
    case ProtobufType::sfixed32: return Wire::four_bytes;
    case ProtobufType::string:
    case ProtobufType::bytes:
    case ProtobufType::message: return Wire::length;
    default: return Wire::varint;
  }
}

/// The number that a zigzag encoding has: 0, -1, 1, -2, ...
std::int64_t unfolded(std::uint64_t bits) { return static_cast<std::int64_t>(bits >> 1 ^ (~(bits & 1) + 1)); }

class ProtobufWalk : public PayloadWalk {
 public:
  ProtobufWalk(const Schema& schema, std::string& path, Visitor& visitor) : PayloadWalk(schema, path, visitor) {}

  /// A field that the message leaves out has its default: 0, an empty text, a message of defaults.
  void message(const Definition& definition, std::span<const std::byte> bytes) {
    std::vector<ProtobufField> fields;  // in the order of the message, where fields of one number need not be together
    ProtobufReader reader(bytes);
    while (const auto field = reader.next()) fields.push_back(*field);
    if (!reader.ok()) return fail(fmt::format("breaks its schema: {} ends within a field, or isn't protobuf", place()));
    visitor_.begin_message();
    for (const FieldDefinition& field : definition.fields) {
      if (!ok()) return;
      const Segment segment(path_, field.name);
      visitor_.field(field.name);
      this->field(field, fields);
    }
    if (ok()) visitor_.end_message();
  }

 private:
  std::string_view place() const { return path_.empty() ? "the message" : std::string_view(path_); }

  void field(const FieldDefinition& definition, const std::vector<ProtobufField>& fields) {
    const auto type = static_cast<ProtobufType>(definition.protobuf_type);
    const Wire wire = wire_of(type);
    const bool is_many = definition.type.shape == FieldType::Shape::sequence && type != ProtobufType::bytes;
    std::vector<ProtobufField> found;
    for (const ProtobufField& field : fields) {
      if (field.number != definition.number) continue;
      if (field.wire == wire)
        found.push_back(field);
      else if (is_many && field.wire == Wire::length)
        unpack(field, wire, found);
      else
        return fail(fmt::format("breaks its schema: {} has another type", place()));
    }
    if (is_many)
      return array(static_cast<std::uint32_t>(found.size()),
                   [&](std::uint32_t i) { element(definition.type, type, found[i]); });
    element(definition.type, type, found.empty() ? ProtobufField() : found.back());
  }

  /// Numbers of one field without their tags.
  void unpack(const ProtobufField& packed, Wire wire, std::vector<ProtobufField>& into) {
    ProtobufReader reader(packed.bytes);
    while (reader.ok() && !reader.at_end()) {
      ProtobufField& number = into.emplace_back();
      number.bits = wire == Wire::varint        ? reader.varint()
                    : wire == Wire::eight_bytes ? reader.fixed<std::uint64_t>()
                                                : reader.fixed<std::uint32_t>();
    }
    if (!reader.ok()) fail(fmt::format("breaks its schema: {} ends within a number", place()));
  }

  void element(const FieldType& type, ProtobufType kind, const ProtobufField& field) {
    if (type.is_message) return message(schema_.definitions[type.message], field.bytes);
    Value value;
    const auto low = static_cast<std::uint32_t>(field.bits);
    switch (kind) {
      case ProtobufType::float64: value.number = std::bit_cast<double>(field.bits); break;
      case ProtobufType::float32: value.number = static_cast<double>(std::bit_cast<float>(low)); break;
      case ProtobufType::boolean: set_unsigned(value, field.bits != 0 ? 1 : 0, Value::Kind::boolean); break;
      case ProtobufType::uint64:
      case ProtobufType::fixed64: set_unsigned(value, field.bits); break;
      case ProtobufType::uint32:
      case ProtobufType::fixed32: set_unsigned(value, low); break;
      case ProtobufType::int64:
      case ProtobufType::sfixed64: set_signed(value, static_cast<std::int64_t>(field.bits)); break;
      case ProtobufType::sint32:
      case ProtobufType::sint64: set_signed(value, unfolded(field.bits)); break;
      case ProtobufType::bytes:
        if (type.shape == FieldType::Shape::sequence && type.primitive == Primitive::uint8)
          set_blob(value, field.bytes);
        else
          set_text(value, field.text());
        break;
      case ProtobufType::string: set_text(value, field.text()); break;
      default: set_signed(value, static_cast<std::int32_t>(low));
    }
    emit(value);
  }
};

}  // namespace

std::string walk_protobuf(const Schema& schema, std::span<const std::byte> payload, std::string& path,
                          Visitor& visitor) {
  ProtobufWalk walk(schema, path, visitor);
  walk.message(schema.definitions.front(), payload);
  return walk.take_problem();
}

}  // namespace rehearse::ros2msg
