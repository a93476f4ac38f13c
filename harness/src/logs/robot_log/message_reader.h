// MessageReader: reads payloads of any schema into a message struct, field by field, by name.
//
// A log's own schema describes the layout of its payloads. A type of a different version or vendor may have more
// fields, in a different order. Fields of the struct that the schema lacks keep their default values.
#pragma once

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/ros2msg/ros2msg.h"

namespace rehearse {
namespace detail {

template <class T>
T number_of(const ros2msg::Value& value) {
  switch (value.kind) {
    case ros2msg::Value::Kind::floating: {
      // a value that doesn't fit into an integer is ignored
      if constexpr (std::is_floating_point_v<T>) return static_cast<T>(value.number);
      return T{};
    }
    case ros2msg::Value::Kind::signed_integer: return static_cast<T>(value.integer);
    default: return static_cast<T>(value.unsigned_integer);
  }
}

/// Removes and returns the path's first segment.
inline std::string_view take_segment(std::string_view& path) {
  const std::size_t slash = path.find('/');
  const std::string_view segment = path.substr(0, slash);
  path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  return segment;
}

template <class T>
void put_value(T& into, std::string_view path, const ros2msg::Value& value);

template <class T>
T* element_at(std::vector<T>& sequence, std::size_t index) {
  if (index == sequence.size()) sequence.emplace_back();  // elements come in order
  return index < sequence.size() ? &sequence[index] : nullptr;
}
template <class T, std::size_t N>
T* element_at(std::array<T, N>& array, std::size_t index) {
  return index < N ? &array[index] : nullptr;
}

template <class Many>
void put_element(Many& many, std::string_view path, const ros2msg::Value& value) {
  const std::string_view digits = take_segment(path);
  std::size_t index = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), index).ec != std::errc()) return;
  if (auto* element = element_at(many, index)) put_value(*element, path, value);
}

inline void put_value(std::vector<std::uint8_t>& into, const ros2msg::Value& value) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(value.blob.data());
  into.assign(bytes, bytes + value.blob.size());
}

template <class T>
void put_value(T& into, std::string_view path, const ros2msg::Value& value) {
  if constexpr (msg::MessageStruct<T>) {
    const std::string_view name = take_segment(path);
    msg::for_each_field(into, [&](std::string_view field, auto& member) {
      if (field == name) put_value(member, path, value);
    });
  } else if constexpr (std::is_arithmetic_v<T>) {
    if (value.is_number()) into = number_of<T>(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (value.kind == ros2msg::Value::Kind::text) into.assign(value.text);
  } else if constexpr (std::is_same_v<T, std::vector<std::uint8_t>>) {
    if (value.kind == ros2msg::Value::Kind::blob) put_value(into, value);
  } else {
    put_element(into, path, value);
  }
}

/// Resets the message for the next one: no sequence has an element. The memory stays.
template <class T>
void clear_sequences(T& message) {
  msg::for_each_field(message, [](std::string_view, auto& member) {
    using Member = std::remove_reference_t<decltype(member)>;
    if constexpr (msg::MessageStruct<Member>) {
      clear_sequences(member);
    } else if constexpr (requires { member.emplace_back(); }) {
      member.clear();
    }
  });
}

}  // namespace detail

/// The reason why a payload can't be read.
inline Diagnostic misfit(mcap::Bytes payload) {
  return error(fmt::format("{} bytes that aren't what its schema says", payload.size()));
}

/// True if payloads of two definitions have equal layouts and field names. Bounds don't matter.
inline bool same_layout(const ros2msg::Schema& a, std::size_t of_a, const ros2msg::Schema& b, std::size_t of_b) {
  const auto& ours = a.definitions[of_a].fields;
  const auto& theirs = b.definitions[of_b].fields;
  return std::ranges::equal(ours, theirs, [&](const auto& x, const auto& y) {
    if (x.name != y.name || x.type.is_message != y.type.is_message || x.type.shape != y.type.shape) return false;
    if (x.type.shape == ros2msg::FieldType::Shape::array && x.type.count != y.type.count) return false;
    return x.type.is_message ? same_layout(a, x.type.message, b, y.type.message) : x.type.primitive == y.type.primitive;
  });
}

/// True if the schema's payloads have the layout of a type with this definition.
inline bool has_layout_of(const ros2msg::Schema& schema, std::string_view type, const std::string& definition) {
  if (schema.encoding != ros2msg::Encoding::cdr) return false;
  const auto own = ros2msg::Schema::parse(std::string(type), definition);
  return own && same_layout(*own, 0, schema, 0);
}
template <msg::MessageStruct T>
bool has_layout_of(const ros2msg::Schema& schema) {
  return has_layout_of(schema, T::type_name, msg::schema_text<T>());
}

template <msg::MessageStruct T>
class MessageReader {
 public:
  explicit MessageReader(const ros2msg::Schema& schema) : decoder_(schema), is_own_(has_layout_of<T>(schema)) {}

  /// Null if the payload doesn't fit the schema. Valid until the next call.
  const T* read(mcap::Bytes payload) {
    if (is_own_) {  // the usual case, ten times as fast
      CdrReader reader(payload);
      return msg::decode(reader, message_) ? &message_ : nullptr;
    }
    detail::clear_sequences(message_);
    const bool fits = decoder_.decode(
        payload, [this](const ros2msg::Value& value) { detail::put_value(message_, value.path, value); });
    return fits ? &message_ : nullptr;
  }

 private:
  ros2msg::Decoder decoder_;
  const bool is_own_;  // the schema is that of T
  T message_;
};

}  // namespace rehearse
