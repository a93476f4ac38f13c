// Patterns for names of topics and series.
#pragma once

#include <cstddef>
#include <string_view>

namespace rehearse {

/// True if the pattern matches the whole name. `*` matches any text, also slashes and the empty text; there is no other
/// special character.
constexpr bool matches(std::string_view pattern, std::string_view name) {
  // Position of the last star, and the end of the text that it matches: after a mismatch the star matches one character
  // more.
  std::size_t p = 0, n = 0;
  std::size_t star = std::string_view::npos, swallowed = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      swallowed = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++swallowed;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace rehearse
