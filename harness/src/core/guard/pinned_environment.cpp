// The environment that pins a process. `rehearse`, which links no library of Rehearse, contains this source, too.
#include <rehearse/pin.h>

#include <cstdlib>
#include <cstring>

namespace rehearse {
namespace {

constexpr const char* tunables = "GLIBC_TUNABLES";
/// glibc 2.36 chooses its variants of sin, cos, exp, log, pow, ... by these; without them every x86-64 uses the SSE2
/// ones.
constexpr const char* plain_mathematics = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX";

/// The user's tunables stay; those of Rehearse come last, so glibc uses them.
std::string with_own_tunables() {
  const char* own = std::getenv(tunables);
  if (!own || !*own || std::strstr(own, plain_mathematics)) return own && *own ? own : plain_mathematics;
  return std::string(own) + ":" + plain_mathematics;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> pinned_environment() {
  return {{tunables, with_own_tunables()}, {"GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1"}, {"LP_NUM_THREADS", "1"}};
}

bool is_pinning_off() {
  const char* set = std::getenv("REHEARSE_PIN");
  return set && std::strcmp(set, "off") == 0;
}

void set_pinned_environment() {
  for (const auto& [name, value] : pinned_environment()) setenv(name.c_str(), value.c_str(), 1);
}

}  // namespace rehearse
