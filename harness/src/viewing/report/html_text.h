// Text and style of small pages that need no script. Internal.
#pragma once

#include <string>
#include <string_view>

namespace rehearse {

/// Text with its special letters spelled out.
inline std::string html_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '&': safe += "&amp;"; break;
      case '"': safe += "&quot;"; break;
      default: safe += c;
    }
  }
  return safe;
}

/// The style that all such pages have: light or dark as the reader's browser, tables in the page's width.
inline constexpr std::string_view html_style =
    ":root { color-scheme: light dark; font: 15px/1.4 system-ui, sans-serif }\n"
    "body { margin: 1.5rem auto; max-width: 76rem; padding: 0 1rem }\n"
    "table { border-collapse: collapse; width: 100% }\n"
    "td { padding: .4rem .6rem; vertical-align: top; border-top: 1px solid #8884; overflow-wrap: anywhere }\n";

}  // namespace rehearse
