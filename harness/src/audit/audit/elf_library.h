// The code of a shared library, read from its file.
#pragma once

#include <capstone/capstone.h>
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

/// A shared library as a file.
struct ElfLibrary {
  std::vector<CodeSection> code;
  std::vector<std::uint64_t> startup;  // addresses of the functions that run when it is loaded
  std::vector<std::string> imports;    // undefined symbols, as mangled
};

/// Fails if the file isn't a shared library for x86-64, or if its parts are outside of the file.
Result<ElfLibrary> read_library(const std::filesystem::path& path);

/// A disassembler for x86-64.
class Disassembler {
 public:
  Disassembler() {
    const bool opened = cs_open(CS_ARCH_X86, CS_MODE_64, &handle_) == CS_ERR_OK;
    REHEARSE_ASSERT(opened, "capstone supports x86");
    cs_option(handle_, CS_OPT_SKIPDATA, CS_OPT_ON);  // tables between functions don't end the code
    instruction_ = cs_malloc(handle_);
  }
  ~Disassembler() {
    cs_free(instruction_, 1);
    cs_close(&handle_);
  }
  Disassembler(const Disassembler&) = delete;
  Disassembler& operator=(const Disassembler&) = delete;

  /// Calls `visit` with each instruction from an address on, until it returns false or the section ends.
  template <class Visit>
  void each(const CodeSection& section, std::uint64_t from, const Visit& visit) {
    if (from < section.address || from - section.address >= section.bytes.size()) return;
    const std::uint8_t* bytes = section.bytes.data() + (from - section.address);
    std::size_t left = section.bytes.size() - (from - section.address);
    while (cs_disasm_iter(handle_, &bytes, &left, &from, instruction_))
      if (!visit(*instruction_)) return;
  }

 private:
  csh handle_ = 0;
  cs_insn* instruction_ = nullptr;
};

}  // namespace rehearse
