// A shared library as a file: its code, what runs when it is loaded, what it imports.
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
  std::vector<std::uint64_t> startup;  // addresses of the functions that loading it calls
  std::vector<std::string> imports;    // undefined symbols, as mangled
  bool is_stripped = false;            // has no symbols but those that others link to

  /// Fails if it isn't a shared library for x86-64, or its parts lie outside of the file.
  static Result<ElfLibrary> load(const std::filesystem::path& file);
};

}  // namespace rehearse
