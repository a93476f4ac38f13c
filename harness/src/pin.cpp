#include <rehearse/pin.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace rehearse {
namespace {

constexpr const char* tunables = "GLIBC_TUNABLES";
/// glibc 2.36 picks its variants of sin, cos, exp, log, pow, ... by these; without them all x86-64 take the SSE2 ones.
constexpr const char* plain_mathematics = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX";
/// Set for the second start, so that a program that somehow loses its environment is not started for ever.
constexpr const char* started_again = "REHEARSE_PINNED";

/// The user's own tunables stay, ours come last, which is what glibc listens to.
std::string with_own_tunables() {
  const char* own = std::getenv(tunables);
  if (!own || !*own || std::strstr(own, plain_mathematics)) return own && *own ? own : plain_mathematics;
  return std::string(own) + ":" + plain_mathematics;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> pinned_environment() {
  return {{tunables, with_own_tunables()}, {"GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1"}, {"LP_NUM_THREADS", "1"}};
}

bool is_pinned() {
  for (const auto& [name, value] : pinned_environment()) {
    const char* set = std::getenv(name.c_str());
    if (!set || value != set) return false;
  }
  return true;
}

void set_pinned_environment() {
  for (const auto& [name, value] : pinned_environment()) setenv(name.c_str(), value.c_str(), 1);
}

void pin_process(char** argv) {
  if (is_pinned()) {
    unsetenv(started_again);  // the programs that this one starts may need to be pinned again
    return;
  }
  if (std::getenv(started_again)) return;
  set_pinned_environment();
  setenv(started_again, "1", 1);
  execv("/proc/self/exe", argv);
  unsetenv(started_again);  // it can't be done here; go on as it is
}

}  // namespace rehearse
