#include "matrix_rows.h"

#include <fmt/format.h>
#include <rehearse/pin.h>
#include <sys/personality.h>

#include <cstdlib>
#include <fstream>

namespace rehearse::matrix {
namespace {

constexpr const char* emulator = "qemu-x86_64";

/// A program that this one starts in it has to pin itself.
Row row(std::string name) {
  Row made;
  made.name = std::move(name);
  for (const auto& [variable, value] : pinned_environment()) made.surroundings.variables[variable] = std::nullopt;
  return made;
}

Row in_order(std::string name, Order order) {
  Row made = row(std::move(name));
  made.order = order;
  return made;
}

Row with(std::string name, const std::map<std::string, std::string>& variables, std::filesystem::path folder = {}) {
  Row made = row(std::move(name));
  for (const auto& [variable, value] : variables) made.surroundings.variables[variable] = value;
  made.surroundings.folder = std::move(folder);
  return made;
}

/// The C library keeps small pieces of memory in a cache of its own, past which MALLOC_PERTURB_ does not see.
Row with_memory_full_of(int byte) {
  const std::string text = fmt::format("{:#04x}", byte);
  Row made = with("fresh memory full of " + text, {{"MALLOC_PERTURB_", std::to_string(byte ^ 0xff)},
                                                   {"GLIBC_TUNABLES", "glibc.malloc.tcache_count=0"}});
  made.same_file = false;  // the recording contains the tunable
  made.memory = text;
  return made;
}

Row with_fixed_addresses() {
  Row made = row("addresses not randomised");
  made.surroundings.launcher = {"setarch", "-R"};
  if (!run({"true"}, made.surroundings, "/dev/null")) made.impossible = "setarch -R isn't permitted here";
  return made;
}

Row without_environment() {
  Row made = with("no environment, but another locale and time zone",
                  {{"LANG", "de_DE.UTF-8"}, {"LC_ALL", "de_DE.UTF-8"}, {"TZ", "Asia/Tokyo"}}, "/usr/share");
  made.surroundings.bare = true;
  return made;
}

/// A program that starts itself again leaves the emulator: it has to be pinned from outside.
Row emulated(const std::string& processor, const std::string& word_in_its_name, bool pinned) {
  Row made = row((pinned ? "" : "control: not pinned, ") + ("emulated " + processor));
  made.surroundings.launcher = {emulator, "-cpu", processor};
  made.pins_itself = false;
  made.same_file = false;
  made.has_to_differ = !pinned;
  made.counts_costs = pinned;
  made.processor = word_in_its_name;
  if (pinned)
    for (const auto& [variable, value] : pinned_environment()) made.surroundings.variables[variable] = value;
  if (!is_installed(emulator)) made.impossible = std::string(emulator) + " isn't installed";
  return made;
}

Row on_arm64(const std::filesystem::path& folder) {
  constexpr const char* arm64_emulator = "qemu-aarch64";
  Row made = row("emulated arm64");
  const char* root = std::getenv("REHEARSE_ARM64_ROOT");
  made.surroundings.launcher = {arm64_emulator, "-L", root ? root : "/"};
  made.pins_itself = false;
  made.same_file = false;
  made.processor = "arm64";
  made.build = folder;
  made.equal_elsewhere = std::vector<std::string>{"spring", "spring_late"};
  for (const auto& [variable, value] : pinned_environment()) made.surroundings.variables[variable] = value;
  made.surroundings.variables["REHEARSE_CACHE"] = "off";  // it has convex hulls that x86-64 computed
  if (!root) made.impossible = "REHEARSE_ARM64_ROOT names no folder with arm64 libraries";
  if (!is_installed(arm64_emulator)) made.impossible = std::string(arm64_emulator) + " isn't installed";
  return made;
}

Row not_pinned() {
  Row made = row("control: not pinned");
  made.pins_itself = false;
  made.same_file = false;
  made.has_to_differ = true;
#if defined(__x86_64__)
  const bool has_others = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  const bool has_others = false;
#endif
  if (!has_others) made.impossible = "without AVX2 and FMA, this processor's mathematics is the pinned one";
  return made;
}

Row moved_by_a_last_bit() {
  Row made = row("control: bodies moved by a last bit");
  made.same_file = false;
  made.has_to_differ = true;
  made.nudged = true;
  return made;
}

Row built(const std::string& name, const std::filesystem::path& folder) {
  Row made = row("built by " + name);
  made.build = folder;
  made.same_file = false;
  return made;
}

}  // namespace

std::vector<Row> rows(const std::vector<std::pair<std::string, std::filesystem::path>>& builds) {
  std::vector<Row> all{
      row("in two processes"),
      in_order("twice in one process", Order::twice),
      in_order("after another world", Order::after_another),
      in_order("beside another world, tick by tick", Order::beside_another),
      with_fixed_addresses(),
      with("another layout of the heap",
           {{"MALLOC_ARENA_MAX", "1"}, {"MALLOC_TOP_PAD_", "65536"}, {"MALLOC_MMAP_THRESHOLD_", "4096"}}),
      with_memory_full_of(0x55),
      with_memory_full_of(0xaa),
      with("100 kB more of environment, another folder", {{"MUCH", std::string(100'000, 'x')}}, "/"),
      without_environment(),
      // they would change pixels or mathematics without pinning
      with("a user's own settings", {{"GALLIUM_OVERRIDE_CPU_CAPS", "sse2"}, {"LP_NUM_THREADS", "2"}}),
  };
  for (const auto& [name, folder] : builds) all.push_back(name == "arm64" ? on_arm64(folder) : built(name, folder));
  for (const char* processor : {"Nehalem", "Haswell", "EPYC"}) all.push_back(emulated(processor, processor, true));
  all.push_back(emulated("max", "TCG", true));
  all.push_back(not_pinned());
  all.push_back(emulated("max", "TCG", false));
  all.push_back(moved_by_a_last_bit());
  return all;
}

bool addresses_are_random() {
  std::ifstream stream("/proc/sys/kernel/randomize_va_space");
  int how = 0;
  stream >> how;
  return how != 0 && (personality(0xffffffff) & ADDR_NO_RANDOMIZE) == 0;
}

}  // namespace rehearse::matrix
