// Reads the entries of a folder from its descriptor.
#include "zoo.h"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

namespace {

class FolderEntries : public ZooController {
  bool begin() override {
    char entries[4096];
    const int folder = open("/etc", O_RDONLY | O_DIRECTORY);
    count_ = static_cast<int>(getdents64(folder, entries, sizeof entries));
    close(folder);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FolderEntries)
