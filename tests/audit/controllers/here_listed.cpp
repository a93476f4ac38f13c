// Counts the entries of the working folder.
#include "zoo.h"

#include <dirent.h>

namespace {

class HereListed : public ZooController {
  bool begin() override {
    DIR* here = opendir(".");
    while (here && readdir(here)) ++count_;
    if (here) closedir(here);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HereListed)
