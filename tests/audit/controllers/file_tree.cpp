// Counts the files of a tree by nftw().
#include "zoo.h"

#include <ftw.h>

namespace {

class FileTree : public ZooController {
  bool begin() override {
    static int count;
    count = 0;
    nftw(
        "/etc/apt", [](const char*, const struct stat*, int, FTW*) { return ++count, 0; }, 8, FTW_PHYS);
    count_ = count;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FileTree)
