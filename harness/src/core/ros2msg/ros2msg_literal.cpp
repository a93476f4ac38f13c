#include "ros2msg_literal.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

namespace rehearse::ros2msg {

std::string_view trim(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

namespace {

bool is_quoted(std::string_view text) {
  return text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.front() == text.back();
}

bool is_boolean(std::string_view text) {
  for (const std::string_view known : {"true", "false", "True", "False", "TRUE", "FALSE", "1", "0"}) {
    if (text == known) return true;
  }
  return false;
}

/// Parses decimal or 0x, with a sign.
template <class Integer>
bool is_integer(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::uint64_t magnitude = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), magnitude, hexadecimal ? 16 : 10);
  if (text.empty() || status != std::errc() || end != text.data() + text.size()) return false;
  const auto largest = static_cast<std::uint64_t>(std::numeric_limits<Integer>::max());
  if (!negative) return magnitude <= largest;
  return magnitude == 0 || (std::numeric_limits<Integer>::is_signed && magnitude <= largest + 1);
}

bool is_floating(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status != std::errc::invalid_argument && end == text.data() + text.size();
}

bool is_string(std::string_view text) {
  const bool begins_quoted = !text.empty() && (text.front() == '"' || text.front() == '\'');
  return !begins_quoted || is_quoted(text);
}

struct PrimitiveForm {
  std::string_view name;
  Primitive primitive;
  bool (*is_value)(std::string_view text);
};

/// The usual name of a primitive comes first.
constexpr PrimitiveForm primitive_forms[] = {{"bool", Primitive::boolean, is_boolean},
                                             {"int8", Primitive::int8, is_integer<std::int8_t>},
                                             {"uint8", Primitive::uint8, is_integer<std::uint8_t>},
                                             {"int16", Primitive::int16, is_integer<std::int16_t>},
                                             {"uint16", Primitive::uint16, is_integer<std::uint16_t>},
                                             {"int32", Primitive::int32, is_integer<std::int32_t>},
                                             {"uint32", Primitive::uint32, is_integer<std::uint32_t>},
                                             {"int64", Primitive::int64, is_integer<std::int64_t>},
                                             {"uint64", Primitive::uint64, is_integer<std::uint64_t>},
                                             {"float32", Primitive::float32, is_floating},
                                             {"float64", Primitive::float64, is_floating},
                                             {"string", Primitive::string, is_string},
                                             {"byte", Primitive::uint8, is_integer<std::uint8_t>},
                                             {"char", Primitive::uint8, is_integer<std::uint8_t>}};

const PrimitiveForm& form_of(Primitive primitive) {
  return *std::ranges::find(primitive_forms, primitive, &PrimitiveForm::primitive);
}

std::string element_problem(const FieldType& type, std::string_view text) {
  if (!form_of(type.primitive).is_value(text)) return fmt::format("'{}' is no {}", text, name_of(type.primitive));
  if (type.primitive != Primitive::string || type.string_bound == 0) return {};
  const std::size_t size = is_quoted(text) ? text.size() - 2 : text.size();
  if (size <= type.string_bound) return {};
  return fmt::format("{} has {} characters of at most {}", text, size, type.string_bound);
}

/// Splits at commas outside of quotes.
std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  if (trim(text).empty()) return parts;
  char quote = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == '\\') ++i;
      if (c == quote) quote = 0;
    } else if ((c == '"' || c == '\'') && trim(text.substr(begin, i - begin)).empty()) {
      quote = c;
    } else if (c == ',') {
      parts.push_back(trim(text.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  parts.push_back(trim(text.substr(begin)));
  return parts;
}

}  // namespace

std::string literal_problem(const FieldType& type, std::string_view text) {
  if (type.shape == FieldType::Shape::single) return element_problem(type, text);
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') {
    return fmt::format("'{}' is no list in brackets", text);
  }
  const std::vector<std::string_view> parts = split(text.substr(1, text.size() - 2));
  for (const std::string_view part : parts) {
    if (std::string wrong = element_problem(type, part); !wrong.empty()) return wrong;
  }
  const bool is_array = type.shape == FieldType::Shape::array;
  if (is_array && parts.size() != type.count) {
    return fmt::format("has {} elements and should have {}", parts.size(), type.count);
  }
  if (!is_array && type.count != 0 && parts.size() > type.count) {
    return fmt::format("has {} elements of at most {}", parts.size(), type.count);
  }
  return {};
}

std::string_view without_quotes(const FieldType& type, std::string_view text) {
  const bool quoted = type.primitive == Primitive::string && is_quoted(text);
  return quoted ? text.substr(1, text.size() - 2) : text;
}

std::string_view name_of(Primitive primitive) { return form_of(primitive).name; }

std::optional<Primitive> find_primitive(std::string_view name) {
  const auto found = std::ranges::find(primitive_forms, name, &PrimitiveForm::name);
  return found == std::end(primitive_forms) ? std::nullopt : std::optional(found->primitive);
}

}  // namespace rehearse::ros2msg
