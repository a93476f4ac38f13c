// Patterns over names of topics and series.
#pragma once

#include <cstddef>
#include <string_view>

namespace rehearse {

/// True if the pattern matches the whole name. `*` stands for any text, slashes and nothing included; there is no other
/// special character.
constexpr bool matches(std::string_view pattern, std::string_view name) {
  // Where the last star was seen, and how much of the name it has swallowed: on a mismatch it swallows one more.
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
