#include "library_scan.h"

#include <capstone/capstone.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "elf_library.h"
#include "symbols.h"

namespace rehearse {
namespace {

using Kind = CodeKind;

constexpr std::string_view kind_names[] = {"fast_math_startup", "float_mode_change",  "fused_arithmetic",
                                           "approximation",     "time_stamp_counter", "hardware_random",
                                           "processor_query",   "direct_syscall",     "imported_source"};

/// The kind of finding for an instruction, if any.
std::optional<Kind> kind_of(std::string_view mnemonic) {
  const auto begins_with_one_of = [&](std::initializer_list<std::string_view> beginnings) {
    return std::ranges::any_of(beginnings, [&](std::string_view beginning) { return mnemonic.starts_with(beginning); });
  };
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, mnemonic) != names.end();
  };
  switch (mnemonic.empty() ? 0 : mnemonic[0]) {
    case 'v':
      if (begins_with_one_of({"vfmadd", "vfmsub", "vfnmadd", "vfnmsub"})) return Kind::fused_arithmetic;
      if (begins_with_one_of({"vrcp", "vrsqrt"})) return Kind::approximation;
      if (mnemonic == "vldmxcsr") return Kind::float_mode_change;
      return std::nullopt;
    case 'r':
      if (begins_with_one_of({"rcpp", "rcps", "rsqrt"})) return Kind::approximation;
      if (is_one_of({"rdtsc", "rdtscp", "rdpmc"})) return Kind::time_stamp_counter;
      if (is_one_of({"rdrand", "rdseed"})) return Kind::hardware_random;
      if (mnemonic == "rdpid") return Kind::processor_query;
      return std::nullopt;
    case 'f':
      if (is_one_of({"fsin", "fcos", "fsincos", "fptan", "fpatan", "f2xm1", "fyl2x", "fyl2xp1"}))
        return Kind::approximation;
      return std::nullopt;  // fldcw sets the rounding of long double to a whole number, and is undone at once
    case 'l': return mnemonic == "ldmxcsr" ? std::optional(Kind::float_mode_change) : std::nullopt;
    case 'c': return mnemonic == "cpuid" ? std::optional(Kind::processor_query) : std::nullopt;
    case 'x': return mnemonic == "xgetbv" ? std::optional(Kind::processor_query) : std::nullopt;
    case 's': return is_one_of({"syscall", "sysenter"}) ? std::optional(Kind::direct_syscall) : std::nullopt;
    default: return std::nullopt;
  }
}

/// capstone 4 takes rdpid for rdseed, which has no such prefix.
std::string_view name_of(const cs_insn& instruction) {
  const std::string_view mnemonic = instruction.mnemonic;
  return mnemonic == "rdseed" && instruction.bytes[0] == 0xf3 ? "rdpid" : mnemonic;
}

struct Spot {
  std::int64_t count = 0;
  std::uint64_t first = 0;  // address
  std::string instruction;  // the first one's name
};

/// Determines whether loading the library changes the floating-point mode.
class StartupSearch {
 public:
  explicit StartupSearch(const ElfLibrary& library) : library_(library) {}

  /// The address of the instruction that changes it.
  std::optional<std::uint64_t> find() {
    for (const std::uint64_t function : library_.startup) search(function, most_calls);
    return found_;
  }

 private:
  static constexpr int most_calls = 3;            // depth of calls
  static constexpr int most_instructions = 2000;  // of one function

  void search(std::uint64_t function, int calls_left) {
    if (found_ || !seen_.insert(function).second) return;
    std::vector<std::uint64_t> called;
    for (const CodeSection& section : library_.code) {
      int count = 0;
      disassembler_.each(section, function, [&](const cs_insn& instruction) {
        const std::string_view name = instruction.mnemonic;
        if (name == "ldmxcsr" || name == "vldmxcsr") found_ = instruction.address;
        if (name == "call" || name == "jmp")
          if (const char* target = instruction.op_str; std::string_view(target).starts_with("0x"))
            called.push_back(std::strtoull(target, nullptr, 16));
        return !found_ && !name.starts_with("ret") && name != "jmp" && name != "ud2" && ++count < most_instructions;
      });
    }
    if (calls_left == 0) return;
    for (const std::uint64_t next : called) search(next, calls_left - 1);
  }

  const ElfLibrary& library_;
  Disassembler disassembler_;
  std::set<std::uint64_t> seen_;
  std::optional<std::uint64_t> found_;
};

std::map<Kind, Spot> remarkable_instructions(const ElfLibrary& library, std::optional<std::uint64_t> startup) {
  std::map<Kind, Spot> spots;
  Disassembler disassembler;
  for (const CodeSection& section : library.code)
    disassembler.each(section, section.address, [&](const cs_insn& instruction) {
      const std::string_view name = name_of(instruction);
      const auto kind = kind_of(name);
      if (!kind || (startup == instruction.address)) return true;
      Spot& spot = spots[*kind];
      if (spot.count++ > 0) return true;
      spot.first = instruction.address;
      spot.instruction = name;
      return true;
    });
  return spots;
}

/// The compiler's own start-up code has a name; without symbols it is still the most likely cause.
std::string_view why_at_startup(std::string_view where) {
  if (where.find("set_fast_math") != std::string_view::npos)
    return ", since it was linked with -ffast-math, -Ofast or -funsafe-math-optimizations";
  if (where.find('(') == std::string_view::npos)
    return "; it was probably linked with -ffast-math, -Ofast or -funsafe-math-optimizations";
  return "";
}

std::string sentence_of(Kind kind, const Spot& spot, const std::string& where) {
  const std::string times = spot.count == 1 ? "" : fmt::format(" and {} more", spot.count - 1);
  const std::string it = fmt::format("{} in {}{}", spot.instruction, where, times);
  switch (kind) {
    case Kind::fast_math_startup:
      return fmt::format(
          "loading it switches the whole process to another floating-point mode, flush-to-zero: {} in {}{}",
          spot.instruction, where, why_at_startup(where));
    case Kind::float_mode_change: return "it changes the floating-point mode: " + it;
    case Kind::fused_arithmetic:
      return "it multiplies and adds with one rounding instead of two, as processors without FMA can't: " + it +
             " (compiled with -march=native, -mfma or the like; -ffp-contract=off turns it off)";
    case Kind::approximation:
      return "it computes with instructions whose last bits differ from processor to processor: " + it;
    case Kind::time_stamp_counter: return "it reads the processor's time: " + it;
    case Kind::hardware_random: return "it draws random numbers from the processor: " + it;
    case Kind::processor_query: return "it asks which processor it runs on: " + it;
    case Kind::direct_syscall: return "it calls the kernel past the C library: " + it;
    case Kind::imported_source: break;
  }
  return {};
}

AuditedCode finding_of(Kind kind, const Spot& spot, const Symbols& symbols) {
  const auto at = symbols.find(spot.first);
  return {std::string(to_string(kind)), spot.count, at.function,
          at.line.empty() ? symbols.address_text(spot.first) : at.line,
          sentence_of(kind, spot, symbols.describe(spot.first))};
}

void add_imports(const ElfLibrary& library, std::vector<AuditedCode>& findings) {
  std::map<std::string, ObservedCall::Source> sources;  // one function may be imported as several symbols
  for (const std::string& symbol : library.imports)
    if (auto found = source_of_symbol(symbol)) sources.emplace(std::move(found->name), found->source);
  for (const auto& [name, source] : sources)
    findings.push_back({std::string(to_string(Kind::imported_source)), 1, name, "",
                        fmt::format("it can call {} ({})", name, to_string(source))});
}

}  // namespace

Result<std::vector<AuditedCode>> scan_library(const std::filesystem::path& file) {
  const auto library = REHEARSE_TRY(read_library(file));
  const Symbols symbols(file);
  std::vector<AuditedCode> findings;
  const auto startup = StartupSearch(library).find();
  if (startup) findings.push_back(finding_of(Kind::fast_math_startup, {1, *startup, "ldmxcsr"}, symbols));
  for (const auto& [kind, spot] : remarkable_instructions(library, startup))
    findings.push_back(finding_of(kind, spot, symbols));
  add_imports(library, findings);
  return findings;
}

std::string_view to_string(CodeKind kind) { return kind_names[static_cast<int>(kind)]; }

}  // namespace rehearse
