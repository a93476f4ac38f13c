#include <rehearse/pin.h>
#include <sys/auxv.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "child_process.h"

namespace rehearse {
namespace {

/// Set for the second start, so that a program that loses its environment is not started for ever.
constexpr const char* started_again = "REHEARSE_PINNED";

/// Why this process isn't pinned; null: it was not tried.
const char* why_not = nullptr;

bool has_pinned_environment() {
  for (const auto& [name, value] : pinned_environment()) {
    const char* set = std::getenv(name.c_str());
    if (!set || value != set) return false;
  }
  return true;
}

/// The state when this library was loaded; programs may change the environment later.
const bool started_pinned = has_pinned_environment();

}  // namespace

bool runs_under_valgrind() {
  const char* preloaded = std::getenv("LD_PRELOAD");
  return preloaded && std::strstr(preloaded, "vgpreload_");
}

bool is_pinned() { return started_pinned; }

std::string pinned_fact() {
  if (is_pinned()) return "yes";
  return std::string("no (") + (why_not ? why_not : "the program didn't pin itself") + ")";
}

std::filesystem::path own_program() {
  std::error_code failed;
  const std::filesystem::path file = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (!failed) return file;
  // Not argv[0], which may have any value.
  const auto* started_as = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  if (!started_as) return {};
  const std::filesystem::path resolved = std::filesystem::canonical(started_as, failed);
  return failed ? std::filesystem::path(started_as) : resolved;
}

void pin_process(char** argv) {
  if (const char* set = std::getenv("REHEARSE_PIN"); set && *set && !is_pinning_off() && std::strcmp(set, "on") != 0) {
    std::fprintf(stderr, "error: REHEARSE_PIN is '%s': it may be 'on' (as if it weren't set) or 'off'\n", set);
    std::exit(2);
  }
  if (is_pinned()) {
    unsetenv(started_again);  // the programs that this one starts may need to be pinned again
    return;
  }
  if (is_pinning_off()) {
    why_not = "REHEARSE_PIN=off";
    return;
  }
  if (runs_under_valgrind()) {
    why_not = "it runs under valgrind, which it would leave";
    return;
  }
  why_not = "it could not start itself again";
  if (std::getenv(started_again)) return;
  const auto pinned = pinned_environment();
  EnvironmentChanges changes(pinned.begin(), pinned.end());
  changes[started_again] = "1";
  replace_process(own_program(), argv, changes);  // by its name, which ps and debuggers show
  replace_process("/proc/self/exe", argv, changes);
  // The second start failed; continue unpinned.
}

}  // namespace rehearse
