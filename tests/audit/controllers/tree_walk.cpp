// Walks a tree of folders by fts_read().
#include "zoo.h"

#include <fts.h>

namespace {

class TreeWalk : public ZooController {
  bool begin() override {
    char path[] = "/etc/apt";
    char* const paths[] = {path, nullptr};
    FTS* tree = fts_open(paths, FTS_PHYSICAL, nullptr);
    while (tree && fts_read(tree)) ++count_;
    if (tree) fts_close(tree);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TreeWalk)
