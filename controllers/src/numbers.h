// Conversion of numbers to and from text, independent of the locale.
#pragma once

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

namespace cnoid {

/// The shortest text that reads back as the same number.
template <class Number>
std::string printNumber(Number number) {
  std::array<char, 32> buffer;  // the longest double has 24 characters
  const std::to_chars_result end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return std::string(buffer.data(), end.ptr);
}

/// Returns false and leaves the number unchanged if the text is not exactly one number.
template <class Number>
bool parseNumber(std::string_view text, Number& number) {
  // from_chars doesn't accept a plus sign
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number parsed{};
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return false;
  number = parsed;
  return true;
}

}  // namespace cnoid
