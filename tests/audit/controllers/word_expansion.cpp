// Counts the files that words of a shell stand for.
#include "zoo.h"

#include <wordexp.h>

namespace {

class WordExpansion : public ZooController {
  bool begin() override {
    wordexp_t found{};
    count_ = wordexp("/etc/*.conf", &found, WRDE_NOCMD) == 0 ? static_cast<int>(found.we_wordc) : 0;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(WordExpansion)
