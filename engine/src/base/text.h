// Text from input files: its numbers, its characters, and its quotes in messages.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace rehearse {

inline constexpr std::size_t longest_quote = 60;  // [bytes]

/// The whole text as a number, read by std::from_chars; nullopt: it is no number, or doesn't fit the type.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, number);
  return status == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

/// The length of the UTF-8 sequence at the beginning of a text that isn't empty (RFC 3629: no overlong forms, no
/// surrogates); 0: there is none. [bytes]
inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  unsigned low = 0x80;
  unsigned high = 0xBF;
  if (lead == 0xE0) low = 0xA0;
  if (lead == 0xED) high = 0x9F;
  if (lead == 0xF0) low = 0x90;
  if (lead == 0xF4) high = 0x8F;
  if (byte(1) < low || byte(1) > high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

/// True if all of the text is UTF-8.
bool is_utf8(std::string_view text);

/// Text from an input file, in a form for a terminal: control characters and bytes that aren't UTF-8 as \xNN.
std::string plain_text(std::string_view text);

/// The text in a form for one line of a message: shortened, without control characters and broken UTF-8.
std::string printable(std::string_view text, std::size_t longest = longest_quote);

/// printable(text, longest) in single quotes, for names and values.
std::string in_quotes(std::string_view text, std::size_t longest = longest_quote);

/// "1 link", "3 links".
std::string count_text(std::int64_t count, std::string_view noun);
std::string count_text(std::integral auto count, std::string_view noun) {
  return count_text(static_cast<std::int64_t>(count), noun);
}

}  // namespace rehearse
