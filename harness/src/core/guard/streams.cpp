#include "streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "result_stream.h"

namespace rehearse {
namespace {

/// Device and inode.
using Identity = std::pair<dev_t, ino_t>;

std::optional<Identity> identity_of(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return {};
  return Identity{status.st_dev, status.st_ino};
}

struct Streams {
  std::map<int, Identity> files;  // by descriptor
  pid_t parent = 0;
} at_start;

}  // namespace

void note_streams(pid_t parent) {
  at_start.parent = parent;
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO, result_descriptor()})
    if (const auto identity = identity_of(descriptor)) at_start.files[descriptor] = *identity;
}

bool restore_streams() {
  bool changed = false;
  for (const auto& [descriptor, identity] : at_start.files) {
    if (identity_of(descriptor) == identity) continue;
    changed = true;
    const std::string of_parent = fmt::format("/proc/{}/fd/{}", at_start.parent, descriptor);
    const int opened = open(of_parent.c_str(), descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY | O_APPEND);
    if (opened < 0 || opened == descriptor) continue;
    dup2(opened, descriptor);
    close(opened);
  }
  return changed;
}

}  // namespace rehearse
