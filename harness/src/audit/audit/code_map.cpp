#include "code_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "elf_library.h"
#include "symbols.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// True for headers that a controller includes of Rehearse.
bool is_of_api(std::string_view path) {
  constexpr std::string_view folder = "/include/";
  const std::size_t at = path.rfind(folder);
  if (at == path.npos) return false;
  const std::string_view name = path.substr(at + folder.size());
  return name.starts_with("cnoid/") || name.starts_with("rehearse/") || name.starts_with("rehearse_");
}

/// The condition of a jump in one of its two encodings without a prefix; none: another instruction.
std::optional<int> condition_of(const cs_insn& instruction) {
  const std::uint8_t *bytes = instruction.bytes, size = static_cast<std::uint8_t>(instruction.size);
  if (size == 2 && (bytes[0] & 0xf0) == 0x70) return bytes[0] & 0x0f;
  if (size == 6 && bytes[0] == 0x0f && (bytes[1] & 0xf0) == 0x80) return bytes[1] & 0x0f;
  return std::nullopt;
}

/// The operand of a jump, the distance from its end.
std::int64_t distance_of(const cs_insn& instruction) {
  if (instruction.size == 2) return static_cast<std::int8_t>(instruction.bytes[1]);
  std::uint32_t distance = 0;
  for (int byte = 3; byte >= 0; --byte) distance = distance << 8 | instruction.bytes[2 + byte];
  return static_cast<std::int32_t>(distance);
}

const CodeSection* section_with(const ElfLibrary& library, std::uint64_t address) {
  const auto found = std::ranges::find_if(library.code, [&](const CodeSection& section) {
    return address >= section.address && address - section.address < section.bytes.size();
  });
  return found == library.code.end() ? nullptr : &*found;
}

bool converts_integer(const cs_insn& instruction) {
  return instruction.id == X86_INS_CVTSI2SD || instruction.id == X86_INS_CVTSI2SS ||
         instruction.id == X86_INS_VCVTSI2SD || instruction.id == X86_INS_VCVTSI2SS;
}

/// True if a number is halved and then converted to a floating one at the address.
bool converts_half(const CodeSection& section, std::uint64_t address) {
  constexpr int most = 8;  // instructions
  Disassembler disassembler;
  bool is_halved = false, converts = false;
  int count = 0;
  disassembler.each(section, address, [&](const cs_insn& instruction) {
    is_halved = is_halved || instruction.id == X86_INS_SHR;
    converts = is_halved && converts_integer(instruction);
    return !converts && ++count < most;
  });
  return converts;
}

/// True for a jump that the source doesn't contain: gcc converts an unsigned number as a signed one, or its half if the
/// highest bit is set.
bool is_of_conversion(const CodeSection& section, const CodeMap::Jump& jump) {
  constexpr int sign = 8;  // the condition of JS
  return jump.condition == sign && converts_half(section, jump.target);
}

/// True if the last option of one of the compilers that sets a level isn't -O0 or -Og.
bool is_optimised(const std::string& compilers) {
  std::istringstream units(compilers);
  for (std::string unit; std::getline(units, unit, ';');) {
    std::istringstream words(unit);
    std::string level = "-O0";
    for (std::string word; words >> word;)
      if (word.starts_with("-O")) level = word;
    if (level != "-O0" && level != "-Og") return true;
  }
  return false;
}

}  // namespace

Result<CodeMap> map_code(const fs::path& file) {
  const auto library = REHEARSE_TRY(read_library(file));
  const Symbols symbols(file);
  LineTable table = symbols.lines();
  CodeMap map;
  map.is_optimised = is_optimised(symbols.compilers());
  map.files = std::move(table.files);
  std::vector<bool> is_own;
  for (const std::string& path : map.files) is_own.push_back(!is_systems_source(path) && !is_of_api(path));

  Disassembler disassembler;
  for (auto row = table.rows.begin(); row != table.rows.end(); ++row) {
    const CodeSection* const section = section_with(library, row->address);
    // The linker leaves rows of removed functions, at addresses outside of the code.
    if (!section || row->line == 0 || !is_own[static_cast<std::size_t>(row->file)]) continue;
    const auto next = row + 1;
    const bool has_code = next != table.rows.end() && next->address != row->address;
    if (row->is_statement || (map.is_optimised && has_code))
      map.statements.push_back({row->address, row->file, row->line, row->is_statement, has_code});
    if (!has_code) continue;
    // Each row begins at an instruction, so that data between functions can't be taken for one.
    disassembler.each(*section, row->address, [&](const cs_insn& instruction) {
      if (instruction.address >= next->address) return false;
      const std::uint64_t end = instruction.address + instruction.size;
      if (const auto condition = condition_of(instruction); condition && instruction.id != 0 && !row->is_implicit) {
        const CodeMap::Jump jump{
            instruction.address, end,       end + static_cast<std::uint64_t>(distance_of(instruction)),
            *condition,          row->file, row->line};
        if (!is_of_conversion(*section, jump)) map.jumps.push_back(jump);
      }
      return end < next->address;
    });
  }
  if (map.statements.empty())
    return error(fmt::format("controller library '{}' has no lines in its debug information", file.filename().string()),
                 "compile it with -g; CMake's RelWithDebInfo has it");
  return map;
}

}  // namespace rehearse
