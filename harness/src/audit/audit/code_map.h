// The statements and conditional jumps of a controller's library, with their lines.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// The code of the controller's own sources: headers of the system, of other packages and of the API are left out. So
/// are jumps without a branch in the source: in functions that the compiler adds, such as a destructor without a
/// definition, and in conversions of unsigned numbers.
struct CodeMap {
  struct Statement {
    std::uint64_t address = 0;  // virtual
    int file = 0;               // index in `files`
    int line = 0;
    bool begins = true;    // false, in an optimised library: the rest of a statement
    bool has_code = true;  // false: another line has the instruction at the address
  };
  struct Jump {
    std::uint64_t address = 0, next = 0, target = 0;  // virtual; `next` follows the jump
    int condition = 0;  // of the instruction, 0 to 15 ("Intel 64 and IA-32 Architectures SDM", vol. 1, appendix B)
    int file = 0;
    int line = 0;
  };
  bool is_optimised = false;  // by the options of the compiler, which debug information of gcc has
  std::vector<std::string> files;
  std::vector<Statement> statements;  // by address, then in the order of the table of lines
  std::vector<Jump> jumps;            // by address
};

/// Fails if the file is no shared library for x86-64, or if it has no debug information.
Result<CodeMap> map_code(const std::filesystem::path& library);

}  // namespace rehearse
