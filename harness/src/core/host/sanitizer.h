// Sanitizers (-fsanitize=) that a controller's library was compiled with.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace rehearse {

struct Sanitizer {
  std::string_view name;     // AddressSanitizer
  std::string_view word;     // of -fsanitize=
  std::string_view symbol;   // that a library needs of it, or the beginning of several
  std::string_view runtime;  // of gcc; empty: the library loads it itself, or gcc has none
  bool comes_first = true;   // its runtime must be in a process before all other libraries
};

/// The sanitizers of a library, by the names that its dynamic section needs. None if the file can't be read.
std::vector<Sanitizer> sanitizers_of(const std::filesystem::path& library);

/// True if the runtime is in this process.
bool is_in_process(const Sanitizer& sanitizer);

}  // namespace rehearse
