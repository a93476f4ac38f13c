#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "payload_walk.h"

namespace rehearse::ros2msg {
namespace {

using Payload = nlohmann::json;

/// The bytes of a text in base64; false: it isn't such a text.
bool decode_base64(std::string_view text, std::vector<std::byte>& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  bytes.clear();
  while (text.ends_with('=')) text.remove_suffix(1);
  std::uint32_t bits = 0;
  int count = 0;  // of the bits that aren't in a byte yet
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> count & 0xff));
  }
  return count < 6;
}

/// The text with "Infinity" instead of each number beyond the range of a double, which the parser refuses.
std::string with_infinities(std::string_view json) {
  std::string text;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::size_t size = quoted ? 0 : std::min(json.find_first_not_of("+-.0123456789eE", i), json.size()) - i;
    if (size > 0 && (json[i] == '-' || std::isdigit(static_cast<unsigned char>(json[i])))) {
      const std::string number(json.substr(i, size));
      const bool is_number = Payload::accept(number.substr(0, number.find_first_of("eE")) + "e0");
      const bool is_beyond = is_number && std::isinf(std::strtod(number.c_str(), nullptr));
      text += !is_beyond ? number : number[0] == '-' ? "\"-Infinity\"" : "\"Infinity\"";
      i += size - 1;
      continue;
    }
    text += json[i];
    if (json[i] == '"') quoted = !quoted;
    if (quoted && json[i] == '\\' && i + 1 < json.size()) text += json[++i];
  }
  return text;
}

/// The number, or the text that stands for one that JSON doesn't have; nullopt: neither.
std::optional<double> number_of(const Payload& json) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (json.is_number()) return json.get<double>();
  if (json == "Infinity") return infinity;
  if (json == "-Infinity") return -infinity;
  if (json == "NaN") return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

class JsonWalk : public PayloadWalk {
 public:
  JsonWalk(const Schema& schema, std::string& path, Visitor& visitor) : PayloadWalk(schema, path, visitor) {}

  void message(const Definition& definition, const Payload& object) {
    if (!object.is_object()) return misfit(object, "an object");
    visitor_.begin_message();
    for (const FieldDefinition& field : definition.fields) {
      if (!ok()) return;
      const auto found = object.find(field.stored_as.empty() ? field.name : field.stored_as);
      if (found == object.end() || found->is_null()) continue;  // properties may be left out
      const Segment segment(path_, field.name);
      visitor_.field(field.name);
      this->field(field.type, *found);
    }
    if (ok()) visitor_.end_message();
  }

 private:
  void misfit(const Payload& value, std::string_view expected) {
    fail(fmt::format("breaks its schema: {} is of type {}, not {}", path_.empty() ? "the message" : path_,
                     value.type_name(), expected));
  }

  void field(const FieldType& type, const Payload& value) {
    if (type.shape == FieldType::Shape::single) return element(type, value);
    if (!type.is_message && type.primitive == Primitive::uint8) return blob(value);
    if (!value.is_array()) return misfit(value, "array");
    array(static_cast<std::uint32_t>(value.size()), [&](std::uint32_t i) { element(type, value[i]); });
  }

  void blob(const Payload& value) {
    if (!value.is_string()) return misfit(value, "string");
    if (!decode_base64(value.get_ref<const std::string&>(), bytes_))
      return fail(fmt::format("breaks its schema: {} isn't base64", path_));
    Value blob;
    set_blob(blob, bytes_);
    emit(blob);
  }

  void element(const FieldType& type, const Payload& json) {
    if (type.is_message) return message(schema_.definitions[type.message], json);
    Value value;
    switch (type.primitive) {
      case Primitive::boolean:
        if (!json.is_boolean()) return misfit(json, "boolean");
        set_unsigned(value, json.get<bool>() ? 1 : 0, Value::Kind::boolean);
        break;
      case Primitive::string:
        if (!json.is_string()) return misfit(json, "string");
        set_text(value, json.get_ref<const std::string&>());
        break;
      case Primitive::float64:
        if (!number_of(json)) return misfit(json, "number");
        value.number = *number_of(json);
        break;
      default:
        if (!take_integer(json, value)) return;
        if (type.primitive == Primitive::uint32) set_unsigned(value, static_cast<std::uint64_t>(value.integer));
    }
    emit(value);
  }

  /// False after a failure. 2.0 is an integer, too.
  bool take_integer(const Payload& json, Value& value) {
    const double number = json.is_number() ? json.get<double>() : 0.5;
    const bool is_whole = json.is_number_integer() || number == std::trunc(number);
    if (!is_whole) return misfit(json, "integer"), false;
    if (number >= 0x1p63 || number < -0x1p63)
      return fail(fmt::format("breaks its schema: {} is {}, beyond the integers of 64 bits", path_, json.dump())),
             false;
    set_signed(value, json.is_number_float() ? static_cast<std::int64_t>(number) : json.get<std::int64_t>());
    return true;
  }

  std::vector<std::byte> bytes_;
};

}  // namespace

std::string walk_json(const Schema& schema, std::span<const std::byte> payload, std::string& path, Visitor& visitor) {
  const std::string_view text(reinterpret_cast<const char*>(payload.data()), payload.size());
  Payload json = Payload::parse(text, nullptr, false);
  if (json.is_discarded()) json = Payload::parse(with_infinities(text), nullptr, false);
  if (json.is_discarded()) return "isn't JSON";
  JsonWalk walk(schema, path, visitor);
  walk.message(schema.definitions.front(), json);
  return walk.take_problem();
}

}  // namespace rehearse::ros2msg
