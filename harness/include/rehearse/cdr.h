// CDR: the encoding of ROS 2 messages as bytes. Classic CDR (XCDR version 1): DDS-XTypes 1.3, section 7.4.3.
//
// A payload begins with four bytes that state the byte order. Each value is aligned to a multiple of its size; offsets
// are counted from the end of these four bytes. A string begins with its length, which includes the final zero. A
// sequence begins with its count. The writer writes little-endian. The reader reads both byte orders, and the plain
// form of XCDR version 2. In this form values of eight bytes are aligned to multiples of four. Writer and reader reuse
// their memory for all messages.
//
// msg::encode, msg::decode and msg::schema_text use one list of a struct's fields, REHEARSE_FIELDS, so they always
// agree. The structs are in messages.h.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rehearse {

/// The types of a single number in CDR.
template <class T>
concept CdrNumber = std::is_arithmetic_v<T> && sizeof(T) <= 8;

class CdrWriter {
 public:
  CdrWriter() { reset(); }

  /// Begins the next message; the memory is reused.
  void reset() {
    size_ = 0;
    constexpr std::uint8_t little_endian[4] = {0, 1, 0, 0};
    std::memcpy(grow(4), little_endian, 4);
  }

  template <CdrNumber T>
  void put(T value) {
    align(sizeof(T));
    std::memcpy(grow(sizeof(T)), &value, sizeof(T));
  }

  /// A string: length with the final zero, characters, zero.
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    std::byte* place = grow(text.size() + 1);
    std::memcpy(place, text.data(), text.size());
    place[text.size()] = std::byte{0};
  }

  /// The elements of an array, without a count.
  template <CdrNumber T>
  void put_array(std::span<const T> values) {
    if (values.empty()) return;
    align(sizeof(T));
    std::memcpy(grow(values.size_bytes()), values.data(), values.size_bytes());
  }

  /// A sequence: count, then elements.
  template <CdrNumber T>
  void put_sequence(std::span<const T> values) {
    put(static_cast<std::uint32_t>(values.size()));
    put_array(values);
  }

  /// The bytes of the message so far; valid until the next call of any member function.
  std::span<const std::byte> bytes() const { return {buffer_.data(), size_}; }

 private:
  void align(std::size_t alignment) {
    const std::size_t padding = (4 - size_) & (alignment - 1);  // counted from the end of the first four bytes
    if (padding != 0) std::memset(grow(padding), 0, padding);
  }
  std::byte* grow(std::size_t count) {
    if (size_ + count > buffer_.size()) buffer_.resize((size_ + count) * 2 + 256);
    std::byte* place = buffer_.data() + size_;
    size_ += count;
    return place;
  }

  std::vector<std::byte> buffer_;
  std::size_t size_ = 0;
};

/// Reads values from a payload in order. After the first value that is missing, ok() stays false, and values are
/// 0 or empty. The reader checks that all bytes of a length are in the payload before it uses this length.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::byte> payload) : bytes_(payload) {
    const int encapsulation = encapsulation_of(payload);
    // The identifiers of RTPS, and older ones of XTypes: even identifiers are big-endian.
    const bool plain = encapsulation == 0x00 || encapsulation == 0x01;
    const bool plain2 =
        encapsulation == 0x06 || encapsulation == 0x07 || encapsulation == 0x10 || encapsulation == 0x11;
    if (!plain && !plain2) {
      fail();
      return;
    }
    swap_ = (encapsulation % 2 == 1) != (std::endian::native == std::endian::little);
    largest_alignment_ = plain ? 8 : 4;
    position_ = 4;
  }

  /// The number in the first two bytes: 0 and 1 are plain CDR; -1 if the payload has fewer than four bytes.
  static int encapsulation_of(std::span<const std::byte> payload) {
    if (payload.size() < 4) return -1;
    return std::to_integer<int>(payload[0]) << 8 | std::to_integer<int>(payload[1]);
  }

  bool ok() const { return ok_; }
  /// Offset of the next value in the payload, before its alignment [bytes]; after a failure the offset of the failure.
  std::size_t position() const { return position_; }
  /// Number of bytes that were not read yet.
  std::size_t left() const { return ok_ ? bytes_.size() - position_ : 0; }
  /// True if the byte order of the payload differs from this machine's.
  bool swapped() const { return swap_; }
  /// True for a payload of XCDR version 2, where arrays and sequences of other types than numbers begin with their size
  /// [bytes].
  bool is_version_2() const { return largest_alignment_ == 4; }

  template <CdrNumber T>
  T get() {
    align(sizeof(T));
    const std::byte* place = take(sizeof(T));
    return place == nullptr ? T{} : load<T>(place);
  }

  /// The string's characters, in the payload.
  std::string_view get_string() {
    const auto length = get<std::uint32_t>();
    const std::byte* place = take(length);
    if (place == nullptr || length == 0) return {};  // some writers write a length of 0 for an empty string
    return {reinterpret_cast<const char*>(place), length - std::size_t{place[length - 1] == std::byte{0}}};
  }

  /// The count of a sequence whose elements take at least `element_size` bytes each; 0 if the payload is too short for
  /// them.
  std::uint32_t get_count(std::size_t element_size) {
    const auto count = get<std::uint32_t>();
    if (!ok_ || count > (bytes_.size() - position_) / (element_size == 0 ? 1 : element_size)) return fail(), 0;
    return count;
  }

  /// Fills all of `values`.
  template <CdrNumber T>
  void get_array(std::span<T> values) {
    if (values.empty()) return;
    align(sizeof(T));
    const std::byte* place = take(values.size_bytes());
    if (place == nullptr) return zero(values);
    if constexpr (std::is_same_v<T, bool>) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = place[i] != std::byte{0};
    } else if (!swap_ || sizeof(T) == 1) {
      std::memcpy(values.data(), place, values.size_bytes());
    } else {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = load<T>(place + i * sizeof(T));
    }
  }

  template <CdrNumber T>
  void get_sequence(std::vector<T>& values) {
    values.resize(get_count(sizeof(T)));
    get_array(std::span<T>(values));
  }

  /// `count` bytes without conversion; null if fewer are left. For callers that interpret these bytes.
  const std::byte* take(std::size_t count) {
    if (!ok_ || count > bytes_.size() - position_) return fail(), nullptr;
    const std::byte* place = bytes_.data() + position_;
    position_ += count;
    return place;
  }

  /// Skips to a multiple of `alignment` (a power of two, at most 8); in version 2 to a multiple of 4 if `alignment` is
  /// 8.
  void align(std::size_t alignment) {
    const std::size_t padding =
        (4 - position_) & ((alignment < largest_alignment_ ? alignment : largest_alignment_) - 1);
    if (padding != 0) take(padding);
  }

 private:
  void fail() { ok_ = false; }

  template <class T>
  static void zero(std::span<T> values) {
    for (T& value : values) value = T{};
  }

  template <CdrNumber T>
  T load(const std::byte* place) const {
    if constexpr (std::is_same_v<T, bool>) {
      return *place != std::byte{0};
    } else {
      T value;
      if (!swap_ || sizeof(T) == 1) {
        std::memcpy(&value, place, sizeof(T));
      } else {
        std::byte turned[sizeof(T)];
        for (std::size_t i = 0; i < sizeof(T); ++i) turned[i] = place[sizeof(T) - 1 - i];
        std::memcpy(&value, turned, sizeof(T));
      }
      return value;
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  std::size_t largest_alignment_ = 8;
  bool swap_ = false;
  bool ok_ = true;
};

}  // namespace rehearse

/// Lists the fields of a message struct, in the order of its schema. Each field has the name of its member. The struct
/// also has a type_name:
///
///   struct Temperature {
///     static constexpr std::string_view type_name = "my_msgs/msg/Temperature";
///     rehearse::msg::Header header;
///     double kelvin = 0.0;
///     REHEARSE_FIELDS(header, kelvin)
///   };
///
/// Types of fields: numbers, bool, std::string, message structs, std::vector of these, std::array of numbers.
#define REHEARSE_FIELDS(...)                                    \
  static constexpr std::string_view field_names = #__VA_ARGS__; \
  template <class Call>                                         \
  constexpr decltype(auto) with_fields(Call&& call) {           \
    return call(__VA_ARGS__);                                   \
  }                                                             \
  template <class Call>                                         \
  constexpr decltype(auto) with_fields(Call&& call) const {     \
    return call(__VA_ARGS__);                                   \
  }

namespace rehearse::msg {

/// A struct with a type_name and REHEARSE_FIELDS: any struct of messages.h.
template <class T>
concept MessageStruct = requires {
  T::type_name;
  T::field_names;
};

/// Calls `visit(name, field)` for each field of the message, in order; name is a std::string_view.
template <class T, class Visit>
void for_each_field(T& message, Visit&& visit);

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

/// The names of a list that is separated by commas.
template <std::size_t count>
constexpr std::array<std::string_view, count> names_in(std::string_view list) {
  std::array<std::string_view, count> names;
  for (std::string_view& name : names) {
    list.remove_prefix(list.find_first_not_of(", "));
    name = list.substr(0, list.find_first_of(", "));
    list.remove_prefix(name.size());
  }
  return names;
}

constexpr std::size_t count_of_names(std::string_view list) {
  std::size_t count = list.empty() ? 0 : 1;
  for (const char character : list) count += character == ',' ? 1 : 0;
  return count;
}

template <MessageStruct T>
inline constexpr auto field_names = names_in<count_of_names(T::field_names)>(T::field_names);

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

template <class T, class Visit>
void for_each_field(T& message, Visit&& visit) {
  const auto visit_all = [&visit](auto&... field) {
    constexpr auto& names = detail::field_names<std::remove_const_t<T>>;
    static_assert(names.size() == sizeof...(field));
    [[maybe_unused]] auto name = names.begin();
    (visit(*name++, field), ...);
  };
  message.with_fields(visit_all);
}

template <MessageStruct T>
void encode(const T& message, CdrWriter& writer) {
  for_each_field(message, [&](std::string_view, const auto& field) { detail::encode_value(field, writer); });
}

template <MessageStruct T>
bool decode(CdrReader& reader, T& message) {
  for_each_field(message, [&](std::string_view, auto& field) { detail::decode_value(reader, field); });
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
      if (!text.empty()) text.append(80, '=').append("\nMSG: ").append(short_name(definition.type)).append("\n");
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
    for_each_field(message, [&](std::string_view name, const auto& field) {
      definitions_[index].fields += type_text(field).append(" ").append(name).append("\n");
    });
    for_each_field(message, [&](std::string_view, const auto& field) { add_used(field); });
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

  std::vector<Definition> definitions_;
};

}  // namespace detail

template <MessageStruct T>
std::string schema_text() {
  return detail::SchemaComposer().compose<T>();
}

}  // namespace rehearse::msg
