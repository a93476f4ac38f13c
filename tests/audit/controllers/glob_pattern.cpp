// Counts the files that a pattern matches.
#include "zoo.h"

#include <glob.h>

namespace {

class GlobPattern : public ZooController {
  bool begin() override {
    glob_t found{};
    count_ = glob("/etc/*.conf", 0, nullptr, &found) == 0 ? static_cast<int>(found.gl_pathc) : 0;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(GlobPattern)
