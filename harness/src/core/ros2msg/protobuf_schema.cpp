#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "other_schemas.h"
#include "protobuf_wire.h"

namespace rehearse::ros2msg {
namespace {

// Numbers of fields in google/protobuf/descriptor.proto.
constexpr std::uint32_t set_file = 1;
constexpr std::uint32_t file_package = 2, file_message = 4;
constexpr std::uint32_t message_name = 1, message_field = 2, message_nested = 3;
constexpr std::uint32_t field_name = 1, field_number = 3, field_label = 4, field_type = 5, field_type_name = 6;
constexpr std::uint64_t label_repeated = 3;

constexpr std::size_t max_messages = 10'000;

struct Field {
  std::string name, type_name;
  std::uint32_t number = 0;
  bool is_repeated = false;
  ProtobufType type = ProtobufType::none;
};

std::optional<Primitive> primitive_of(ProtobufType type) {
  switch (type) {
    case ProtobufType::float64: return Primitive::float64;
    case ProtobufType::float32: return Primitive::float32;
    case ProtobufType::int64:
    case ProtobufType::sfixed64:
    case ProtobufType::sint64: return Primitive::int64;
    case ProtobufType::uint64:
    case ProtobufType::fixed64: return Primitive::uint64;
    case ProtobufType::int32:
    case ProtobufType::enumeration:
    case ProtobufType::sfixed32:
    case ProtobufType::sint32: return Primitive::int32;
    case ProtobufType::uint32:
    case ProtobufType::fixed32: return Primitive::uint32;
    case ProtobufType::boolean: return Primitive::boolean;
    case ProtobufType::string:
    case ProtobufType::bytes: return Primitive::string;
    default: return std::nullopt;
  }
}

/// The messages of a FileDescriptorSet, by their full names: foxglove.JointStates.
class Descriptors {
 public:
  /// False: the bytes are no such set.
  bool read(std::span<const std::byte> set) {
    return each(set, [this](const ProtobufField& field) { return field.number != set_file || file(field.bytes); });
  }
  const std::vector<Field>* find(const std::string& name) const {
    const auto found = messages_.find(name);
    return found == messages_.end() ? nullptr : &found->second;
  }
  /// The full name of a type as it is written in a message: with a dot at its beginning, or to be searched in the
  /// message's scope and those around it.
  std::string full_name(const std::string& written, std::string scope) const {
    if (written.starts_with('.')) return written.substr(1);
    while (!scope.empty() && !messages_.contains(scope + "." + written))
      scope.erase(scope.find('.') == std::string::npos ? 0 : scope.rfind('.'));
    return scope.empty() ? written : scope + "." + written;
  }

 private:
  template <class Take>
  static bool each(std::span<const std::byte> bytes, const Take& take) {
    ProtobufReader reader(bytes);
    while (const auto field = reader.next())
      if (!take(*field)) return false;
    return reader.ok();
  }

  bool file(std::span<const std::byte> bytes) {
    std::string package;
    const bool whole = each(bytes, [&](const ProtobufField& field) {
      if (field.number == file_package) package = std::string(field.text()) + ".";
      return true;
    });
    return whole && each(bytes, [&](const ProtobufField& field) {
             return field.number != file_message || message(field.bytes, package, 0);
           });
  }

  bool message(std::span<const std::byte> bytes, const std::string& scope, int depth) {
    if (depth > 32 || messages_.size() == max_messages) return false;
    std::string name = scope;
    const bool has_name = each(bytes, [&](const ProtobufField& field) {
      if (field.number == message_name) name += field.text();
      return true;
    });
    if (!has_name) return false;
    std::vector<Field> fields;
    const bool whole = each(bytes, [&](const ProtobufField& field) {
      if (field.number == message_nested) return message(field.bytes, name + ".", depth + 1);
      if (field.number == message_field) fields.emplace_back();
      return field.number != message_field ||
             each(field.bytes, [&](const ProtobufField& part) { return take_part(part, fields.back()); });
    });
    messages_[name] = std::move(fields);
    return whole;
  }

  static bool take_part(const ProtobufField& part, Field& field) {
    if (part.number == field_name) field.name = part.text();
    if (part.number == field_number) field.number = static_cast<std::uint32_t>(part.bits);
    if (part.number == field_label) field.is_repeated = part.bits == label_repeated;
    if (part.number == field_type) field.type = static_cast<ProtobufType>(part.bits);
    if (part.number == field_type_name) field.type_name = part.text();
    return true;
  }

  std::map<std::string, std::vector<Field>> messages_;
};

class ProtobufSchema {
 public:
  explicit ProtobufSchema(const Descriptors& descriptors) : descriptors_(descriptors) {}

  /// Adds a message; none: it isn't defined, or contains itself.
  std::optional<std::size_t> add(const std::string& name) {
    if (const auto known = indices_.find(name); known != indices_.end()) return known->second;
    const std::vector<Field>* fields = descriptors_.find(name);
    if (!fields || std::ranges::find(open_, name) != open_.end() || open_.size() > 32) return std::nullopt;
    open_.push_back(name);
    const std::size_t index = schema.definitions.size();
    schema.definitions.emplace_back();
    schema.definitions[index].name = name;
    std::vector<FieldDefinition> definitions;
    for (const Field& field : *fields)
      if (auto definition = definition_of(field, name)) definitions.push_back(*std::move(definition));
    if (name == "google.protobuf.Timestamp" || name == "google.protobuf.Duration") {
      for (FieldDefinition& field : definitions) {  // as in ROS 2
        field.name = field.name == "seconds" ? "sec" : field.name == "nanos" ? "nanosec" : field.name;
        if (field.name != "nanosec" || name.ends_with("Duration")) continue;
        field.type.primitive = Primitive::uint32;
        field.protobuf_type = static_cast<std::uint8_t>(ProtobufType::uint32);
      }
    }
    schema.definitions[index].fields = std::move(definitions);
    open_.pop_back();
    indices_.emplace(name, index);
    return index;
  }

  Schema schema;

 private:
  /// `message`: the name of the message that has the field. None: it can't be read.
  std::optional<FieldDefinition> definition_of(const Field& field, const std::string& message) {
    FieldDefinition definition;
    definition.name = field.name;
    definition.number = field.number;
    definition.protobuf_type = static_cast<std::uint8_t>(field.type);
    FieldType& type = definition.type;
    if (field.is_repeated) type.shape = FieldType::Shape::sequence;
    if (field.type == ProtobufType::message) {
      const auto inner = add(descriptors_.full_name(field.type_name, message));
      if (!inner) return std::nullopt;
      type.is_message = true;
      type.message = *inner;
    } else if (field.type == ProtobufType::bytes && !field.is_repeated) {
      type.primitive = Primitive::uint8;
      type.shape = FieldType::Shape::sequence;
    } else {
      const auto primitive = primitive_of(field.type);
      if (!primitive) return std::nullopt;
      type.primitive = *primitive;
    }
    return definition;
  }

  const Descriptors& descriptors_;
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> open_;  // the messages that contain the present one
};

}  // namespace

Result<Schema> parse_protobuf(std::string_view type, std::string_view text, std::string file) {
  Descriptors descriptors;
  if (!descriptors.read(std::as_bytes(std::span(text.data(), text.size()))))
    return error_in(std::move(file), "the schema isn't a FileDescriptorSet of protobuf");
  ProtobufSchema parsed(descriptors);
  if (!parsed.add(std::string(type)))
    return error_in(std::move(file), fmt::format("the schema doesn't define the message {}", type));
  return std::move(parsed.schema);
}

}  // namespace rehearse::ros2msg
