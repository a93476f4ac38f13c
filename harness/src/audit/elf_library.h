// A shared library as a file: its code, its start-up functions, its imports.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

struct CodeSection {
  std::uint64_t address = 0;  // virtual
  std::vector<std::uint8_t> bytes;
};

struct ElfLibrary {
  std::vector<CodeSection> code;
  std::vector<std::uint64_t> startup;  // addresses of the functions that run when it is loaded
  std::vector<std::string> imports;    // undefined symbols, as mangled
  bool is_stripped = false;            // it has only the symbols that other libraries link to

  /// Fails if it isn't a shared library for x86-64, or if its parts are outside of the file.
  static Result<ElfLibrary> load(const std::filesystem::path& file);
};

}  // namespace rehearse
