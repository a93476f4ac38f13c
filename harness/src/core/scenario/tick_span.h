// Spans of ticks as written on a command line, and the form of messages on their mistakes.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace rehearse {

struct TickSpan {
  std::int64_t first = 0;
  std::int64_t last = 0;  // inclusive

  bool has(std::int64_t tick) const { return first <= tick && tick <= last; }
};

/// The words of a command line, and a place in them.
struct WordPlace {
  std::string_view text;
  std::size_t begin = 0;
  std::size_t size = 0;
};

/// The message, then the words with a caret under the place.
Diagnostic error_at(const WordPlace& place, const std::string& message);

/// "tick:1200..1300" (both included), "tick:1200", "3.2s..3.4s" (3.4 s not included), "3.2s" (one tick). `text` is all
/// of the words, `begin` the offset of the span in it.
Result<TickSpan> parse_span(std::string_view text, std::size_t begin, double time_step);

}  // namespace rehearse
