// Types of the MCAP library that headers without mcap.h use, too. C++17: tests include it through trace.h.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace rehearse::mcap {

using StringMap = std::map<std::string, std::string>;

/// The place of a message, for Reader::message_at.
struct Location {
  std::uint64_t record = 0;  // byte offset in the file of the chunk, or of the message itself if it is in none
  std::uint64_t inside = 0;  // byte offset of the message's record in the chunk's decompressed records; 0 if in none
  bool chunked = false;
};

}  // namespace rehearse::mcap
