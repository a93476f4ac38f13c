// Quotes text from input files in messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rehearse {

inline constexpr std::size_t longest_quote = 60;  // [bytes]

/// True if the bytes are UTF-8 (RFC 3629: no overlong forms, no surrogates).
bool is_utf8(std::string_view text);

/// The text in a form for one line of a message: shortened, without control characters and broken UTF-8.
std::string printable(std::string_view text, std::size_t longest = longest_quote);

/// printable(text, longest) in single quotes, for names and values.
std::string in_quotes(std::string_view text, std::size_t longest = longest_quote);

}  // namespace rehearse
