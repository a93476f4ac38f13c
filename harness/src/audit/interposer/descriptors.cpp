// Logs a controller that closes file descriptors of others.
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "descriptors.h"
#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

constexpr int most_descriptors = 1024;
bool is_hosts[most_descriptors];
char relative_names[most_descriptors][256];  // longer ones are cut

}  // namespace

void remember_open_descriptors() {
  for (bool& open : is_hosts) open = false;
  DIR* folder = opendir("/proc/self/fd");
  if (!folder) return;
  while (const dirent* entry = readdir(folder)) {
    const long descriptor = strtol(entry->d_name, nullptr, 10);
    if (entry->d_name[0] != '.' && descriptor < most_descriptors && descriptor != dirfd(folder))
      is_hosts[descriptor] = true;
  }
  closedir(folder);
}

int now_controllers(int descriptor) {
  if (descriptor >= 0 && descriptor < most_descriptors) is_hosts[descriptor] = false;
  return descriptor;
}

const char* relative_name_of(int descriptor) {
  return descriptor >= 0 && descriptor < most_descriptors ? relative_names[descriptor] : "";
}

void set_relative_name(int descriptor, const char* name) {
  if (descriptor < 0 || descriptor >= most_descriptors) return;
  char* const to = relative_names[descriptor];
  if (*to || *name) snprintf(to, sizeof relative_names[0], "%s", name);
}

REHEARSE_INTERPOSED(int, close, (int descriptor)) {
  set_relative_name(descriptor, "");
  if (watching() && descriptor >= 0 && descriptor < most_descriptors && is_hosts[descriptor]) {
    const Caller caller = note(source_of::close, "close", Digits(descriptor), __builtin_return_address(0));
    if (caller.is_controller) now_controllers(descriptor);
  }
  return next_close.get()(descriptor);
}

REHEARSE_NOTED(void, closefrom, (int first), (first), Digits(first))
REHEARSE_NOTED(int, close_range, (unsigned first, unsigned last, int flags), (first, last, flags), Digits(first))

}  // namespace rehearse::interposer
