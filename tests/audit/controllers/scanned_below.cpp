// Lists a folder by scandirat(), by its name in an opened folder.
#include "zoo.h"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

namespace {

class ScannedBelow : public ZooController {
  bool begin() override {
    const int folder = open("/etc", O_RDONLY | O_DIRECTORY);
    dirent** entries = nullptr;
    count_ = scandirat(folder, "apt", &entries, nullptr, alphasort);
    close(folder);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScannedBelow)
