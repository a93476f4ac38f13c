// What opens a report at a moment: a terminal makes a link of it.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rehearse::tool {

/// "file:///home/me/a%20run.html#tick=123"; without a tick it opens at its beginning.
inline std::string report_link(const std::filesystem::path& file, std::optional<std::int64_t> tick) {
  constexpr std::string_view plain = "/-._~";
  std::error_code ignored;
  std::string link = "file://";
  for (const char c : std::filesystem::absolute(file, ignored).lexically_normal().string()) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_letter || plain.find(c) != std::string_view::npos)
      link += c;
    else
      link += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return tick ? link + fmt::format("#tick={}", *tick) : link;
}

}  // namespace rehearse::tool
