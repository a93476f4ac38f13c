#include "text.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse {

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view text, std::size_t longest) {
  std::string shown;
  while (!text.empty()) {
    if (shown.size() >= longest) {
      shown += "...";
      break;
    }
    const std::size_t length = utf8_length(text);
    const unsigned char first = static_cast<unsigned char>(text.front());
    const bool is_visible = length > 0 && first >= 0x20 && first != 0x7F;
    shown += is_visible ? text.substr(0, length) : std::string_view("?");
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

std::string plain_text(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t length = utf8_length(text);
    const bool control =
        first < 0x20 || first == 0x7f || (length == 2 && first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0);
    if (length == 0 || control) {
      plain += fmt::format("\\x{:02x}", first);
      text.remove_prefix(1);
      if (length == 2) {
        plain += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
        text.remove_prefix(1);
      }
    } else {
      plain += text.substr(0, length);
      text.remove_prefix(length);
    }
  }
  return plain;
}

std::string in_quotes(std::string_view text, std::size_t longest) { return "'" + printable(text, longest) + "'"; }

std::string count_text(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace rehearse
