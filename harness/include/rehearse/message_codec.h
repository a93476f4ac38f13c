// Encodes a struct that lists its fields as bytes, decodes it, and makes the text of its schema.
//
// All three use one list, T::for_each_field(), so they always agree. The structs are in messages.h.
#pragma once

#include <rehearse/cdr.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace rehearse::msg {

/// A struct that lists its fields: any struct of messages.h.
template <class T>
concept MessageStruct = requires {
  T::type_name;
};

/// Appends the message to the writer; begin with writer.reset().
template <MessageStruct T>
void encode(const T& message, CdrWriter& writer);

/// Reads all fields, reusing the memory of `message`; returns reader.ok().
template <MessageStruct T>
bool decode(CdrReader& reader, T& message);

/// The complete ros2msg text of the type: its fields, then each type that it uses under its own heading.
template <MessageStruct T>
std::string schema_text();

namespace detail {

template <CdrNumber T>
void encode_value(T value, CdrWriter& writer) {
  writer.put(value);
}
inline void encode_value(const std::string& text, CdrWriter& writer) { writer.put(std::string_view(text)); }
inline void encode_value(const std::vector<bool>& values, CdrWriter& writer) {
  writer.put(static_cast<std::uint32_t>(values.size()));
  for (const bool value : values) writer.put(value);
}
template <MessageStruct T>
void encode_value(const T& message, CdrWriter& writer) {
  encode(message, writer);
}
template <CdrNumber T, std::size_t N>
void encode_value(const std::array<T, N>& values, CdrWriter& writer) {
  writer.put_array(std::span<const T>(values));
}
template <class T>
void encode_value(const std::vector<T>& values, CdrWriter& writer) {
  if constexpr (CdrNumber<T>) {
    writer.put_sequence(std::span<const T>(values));
  } else {
    writer.put(static_cast<std::uint32_t>(values.size()));
    for (const T& value : values) encode_value(value, writer);
  }
}

template <CdrNumber T>
void decode_value(CdrReader& reader, T& value) {
  value = reader.get<T>();
}
inline void decode_value(CdrReader& reader, std::string& text) { text = reader.get_string(); }
inline void decode_value(CdrReader& reader, std::vector<bool>& values) {
  values.resize(reader.get_count(1));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = reader.get<bool>();
}
template <MessageStruct T>
void decode_value(CdrReader& reader, T& message) {
  decode(reader, message);
}
template <CdrNumber T, std::size_t N>
void decode_value(CdrReader& reader, std::array<T, N>& values) {
  reader.get_array(std::span<T>(values));
}
template <class T>
void decode_value(CdrReader& reader, std::vector<T>& values) {
  if constexpr (CdrNumber<T>) {
    reader.get_sequence(values);
  } else {
    const std::uint32_t count = reader.get_count(1);
    std::size_t i = 0;  // grows with the elements that were read, not with the count
    for (; i < count && reader.ok(); ++i) {
      if (i == values.size()) values.emplace_back();
      decode_value(reader, values[i]);
    }
    values.resize(i);
  }
}

}  // namespace detail

template <MessageStruct T>
void encode(const T& message, CdrWriter& writer) {
  T::for_each_field(message, [&](const char*, const auto& field) { detail::encode_value(field, writer); });
}

template <MessageStruct T>
bool decode(CdrReader& reader, T& message) {
  T::for_each_field(message, [&](const char*, auto& field) { detail::decode_value(reader, field); });
  return reader.ok();
}

namespace detail {

/// Collects the text of a type and of the types that it uses, each once, in order of first use.
class SchemaComposer {
 public:
  template <MessageStruct T>
  std::string compose() {
    add<T>();
    std::string text;
    for (const Definition& definition : definitions_) {
      if (!text.empty()) text += separator + "MSG: " + short_name(definition.type) + "\n";
      text += definition.fields;
    }
    return text;
  }

 private:
  struct Definition {
    std::string_view type;
    std::string fields;
  };

  template <MessageStruct T>
  void add() {
    for (const Definition& definition : definitions_) {
      if (definition.type == T::type_name) return;
    }
    const std::size_t index = definitions_.size();
    definitions_.push_back({T::type_name, {}});
    T message;
    T::for_each_field(message, [&](const char* name, const auto& field) {
      definitions_[index].fields += type_text(field) + " " + name + "\n";
    });
    T::for_each_field(message, [&](const char*, const auto& field) { add_used(field); });
  }

  template <class T>
  void add_used(const T&) {
    if constexpr (MessageStruct<T>) add<T>();
  }
  template <class T>
  void add_used(const std::vector<T>&) {
    if constexpr (MessageStruct<T>) add<T>();
  }

  template <class T>
  static std::string type_text(const T&) {
    if constexpr (MessageStruct<T>) return short_name(T::type_name);
    if constexpr (std::is_same_v<T, bool>) return "bool";
    if constexpr (std::is_same_v<T, double>) return "float64";
    if constexpr (std::is_same_v<T, float>) return "float32";
    if constexpr (std::is_same_v<T, std::string>) return "string";
    if constexpr (std::is_integral_v<T>) {
      return (std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
    }
  }
  template <class T>
  static std::string type_text(const std::vector<T>&) {
    return type_text(T{}) + "[]";
  }
  template <class T, std::size_t N>
  static std::string type_text(const std::array<T, N>&) {
    return type_text(T{}) + "[" + std::to_string(N) + "]";
  }

  /// In ros2msg text the type is std_msgs/Header; in the name of a channel's schema it is std_msgs/msg/Header.
  static std::string short_name(std::string_view type) {
    std::string text(type);
    return text.erase(text.find("/msg/"), 4);
  }

  inline static const std::string separator = std::string(80, '=') + "\n";
  std::vector<Definition> definitions_;
};

}  // namespace detail

template <MessageStruct T>
std::string schema_text() {
  return detail::SchemaComposer().compose<T>();
}

}  // namespace rehearse::msg
