// Logs a controller that closes file descriptors of others.
#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

#include "descriptors.h"
#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

constexpr int most_descriptors = 1024;
bool is_hosts[most_descriptors];

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

REHEARSE_INTERPOSED(int, close, (int descriptor)) {
  if (watching() && descriptor >= 0 && descriptor < most_descriptors && is_hosts[descriptor]) {
    const Caller caller = note(Source::process, "close", Digits(descriptor), __builtin_return_address(0));
    if (caller.is_controller) now_controllers(descriptor);
  }
  return next_close.get()(descriptor);
}

REHEARSE_NOTED(process, void, closefrom, (int first), (first), Digits(first))
REHEARSE_NOTED(process, int, close_range, (unsigned first, unsigned last, int flags), (first, last, flags),
               Digits(first))

}  // namespace rehearse::interposer
