// Counts the entries of a folder by scandir().
#include "zoo.h"

#include <dirent.h>

namespace {

class ScannedFolder : public ZooController {
  bool begin() override {
    dirent** entries = nullptr;
    count_ = scandir("/etc", &entries, nullptr, alphasort);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScannedFolder)
