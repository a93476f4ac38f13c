#include "code_breakpoints.h"

#include <link.h>
#include <signal.h>
#include <sys/mman.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <list>
#include <vector>

#include "code_map.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t int3 = 0xcc;
constexpr std::int64_t never = -2;
/// A jump that has gone one way this often is no longer watched: each time takes some microseconds.
constexpr int most_evaluations = 10'000;

std::atomic<std::int64_t> watched_tick{-1};

/// A place with a breakpoint. All members may be used in the signal handler, on several threads.
struct Breakpoint {
  std::uint64_t address = 0;  // virtual
  bool is_statement = false;
  std::optional<CodeMap::Jump> jump;
  std::uint8_t replaced = 0;                            // the first byte of the instruction
  std::atomic<std::int64_t> reached{never};             // tick
  std::atomic<std::int64_t> ways[2]{{never}, {never}};  // tick of the first time that a jump is passed, and taken
  std::atomic<int> evaluations{0};
};

struct WatchedLibrary {
  fs::path file;
  std::vector<Breakpoint> breakpoints;  // by address
  std::atomic<std::uintptr_t> base{0};  // 0: it isn't loaded, or its pages can't be written
};

/// A list, because its elements stay at their addresses: threads of a library may run while the next one is added.
std::list<WatchedLibrary> libraries;

#if defined(__x86_64__)

void note_first(std::atomic<std::int64_t>& tick) {
  std::int64_t expected = never;
  tick.compare_exchange_strong(expected, watched_tick.load(std::memory_order_relaxed), std::memory_order_relaxed);
}

std::uint8_t* code_at(std::uintptr_t address) { return reinterpret_cast<std::uint8_t*>(address); }

/// Makes the executable segments writable. Called by the dynamic linker.
bool make_writable(const dl_phdr_info& object) {
  const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || !(segment.p_flags & PF_X)) continue;
    const std::uintptr_t begin = (object.dlpi_addr + segment.p_vaddr) / page * page;
    const std::uintptr_t end = object.dlpi_addr + segment.p_vaddr + segment.p_memsz;
    if (mprotect(code_at(begin), end - begin, PROT_READ | PROT_WRITE | PROT_EXEC) != 0) return false;
  }
  return true;
}

/// Sets the breakpoints of a library that has been mapped since the last call.
int set_breakpoints(dl_phdr_info* object, std::size_t, void*) {
  for (WatchedLibrary& library : libraries) {
    if (library.base != 0 || std::strcmp(library.file.c_str(), object->dlpi_name) != 0) continue;
    if (!make_writable(*object)) continue;
    for (Breakpoint& breakpoint : library.breakpoints) {
      std::uint8_t* const code = code_at(object->dlpi_addr + breakpoint.address);
      breakpoint.replaced = *code;
      *code = int3;
    }
    library.base = object->dlpi_addr;
  }
  return 0;
}

/// True: with these flags a jump with this condition is taken.
bool is_taken(int condition, greg_t flags) {
  const bool carry = flags & 0x001, parity = flags & 0x004, zero = flags & 0x040, sign = flags & 0x080,
             overflow = flags & 0x800;
  const bool holds[] = {overflow, carry, zero, carry || zero, sign, parity, sign != overflow, zero || sign != overflow};
  return holds[condition / 2] != (condition % 2 == 1);
}

/// The function that the dynamic linker calls when it has mapped a library and has run nothing of it. It does nothing;
/// debuggers have their breakpoint there (r_debug.r_brk of <link.h>).
std::uintptr_t linker_notice = 0;

/// Continues behind a breakpoint of a conditional jump, where the jump would continue.
void execute_jump(Breakpoint& breakpoint, std::uintptr_t base, greg_t* registers) {
  const bool taken = is_taken(breakpoint.jump->condition, registers[REG_EFL]);
  note_first(breakpoint.ways[taken]);
  const bool both = breakpoint.ways[!taken].load(std::memory_order_relaxed) != never;
  if (both || breakpoint.evaluations.fetch_add(1, std::memory_order_relaxed) + 1 == most_evaluations)
    *code_at(base + breakpoint.address) = breakpoint.replaced;
  registers[REG_RIP] = static_cast<greg_t>(base + (taken ? breakpoint.jump->target : breakpoint.jump->next));
}

void on_breakpoint(int, siginfo_t*, void* context) {
  greg_t* const registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  const auto address = static_cast<std::uintptr_t>(registers[REG_RIP]) - 1;
  if (address == linker_notice) {
    dl_iterate_phdr(set_breakpoints, nullptr);
    registers[REG_RIP] = *reinterpret_cast<const greg_t*>(registers[REG_RSP]);  // as its RET does
    registers[REG_RSP] += sizeof(greg_t);
    return;
  }
  for (WatchedLibrary& library : libraries) {
    const std::uintptr_t base = library.base;
    if (base == 0) continue;  // its breakpoints may be under construction
    const auto found = std::ranges::lower_bound(library.breakpoints, address - base, {}, &Breakpoint::address);
    if (found == library.breakpoints.end() || found->address != address - base) continue;
    note_first(found->reached);
    if (found->jump) return execute_jump(*found, base, registers);
    *code_at(address) = found->replaced;
    registers[REG_RIP] = static_cast<greg_t>(address);
    return;
  }
  signal(SIGTRAP, SIG_DFL);  // a breakpoint of the controller's own ends the process, as usual
  raise(SIGTRAP);
}

/// Has on_breakpoint() called, also by the dynamic linker; false if that isn't possible.
bool install_handler() {
  static const bool installed = [] {
    struct sigaction action {};
    action.sa_sigaction = on_breakpoint;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    if (sigaction(SIGTRAP, &action, nullptr) != 0) return false;
    const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE)), notice = _r_debug.r_brk;
    if (mprotect(code_at(notice / page * page), page, PROT_READ | PROT_WRITE | PROT_EXEC) != 0) return false;
    *code_at(notice) = int3;
    linker_notice = notice;
    return true;
  }();
  return installed;
}

#else

bool install_handler() { return false; }

#endif

}  // namespace

Result<void> watch_library(const fs::path& file) {
  if (std::ranges::find(libraries, file, &WatchedLibrary::file) != libraries.end()) return {};
  const auto map = REHEARSE_TRY(map_code(file));
  if (!install_handler()) return error("the executed lines can't be found here: the system forbids to change code");
  std::map<std::uint64_t, std::pair<bool, std::optional<CodeMap::Jump>>> places;
  for (const CodeMap::Statement& statement : map.statements) places[statement.address].first = true;
  for (const CodeMap::Jump& jump : map.jumps) places[jump.address].second = jump;
  WatchedLibrary& library = libraries.emplace_back();
  library.file = file;
  library.breakpoints = std::vector<Breakpoint>(places.size());
  auto breakpoint = library.breakpoints.begin();
  for (const auto& [address, place] : places) {
    breakpoint->address = address;
    breakpoint->is_statement = place.first;
    breakpoint->jump = place.second;
    ++breakpoint;
  }
  return {};
}

void set_watched_tick(std::int64_t tick) { watched_tick.store(tick, std::memory_order_relaxed); }

std::map<fs::path, ExecutedCode> executed_code() {
  const auto tick_of = [](const std::atomic<std::int64_t>& tick) {
    return tick == never ? std::nullopt : std::optional(tick.load());
  };
  std::map<fs::path, ExecutedCode> all;
  for (const WatchedLibrary& library : libraries) {
    if (library.base == 0) continue;
    ExecutedCode& code = all[library.file];
    for (const Breakpoint& breakpoint : library.breakpoints) {
      if (breakpoint.is_statement && breakpoint.reached != never)
        code.statements[breakpoint.address] = breakpoint.reached;
      if (breakpoint.jump && breakpoint.reached != never)
        code.jumps[breakpoint.address] = {tick_of(breakpoint.ways[1]), tick_of(breakpoint.ways[0]),
                                          breakpoint.evaluations < most_evaluations};
    }
  }
  return all;
}

}  // namespace rehearse
