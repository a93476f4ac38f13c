// Walks two trees of folders, and counts the entries of the one outside of the working folder.
#include "zoo.h"

#include <fts.h>

namespace {

class TwoTrees : public ZooController {
  bool begin() override {
    char here[] = "zoo_tree", there[] = "/etc/apt";
    char* const paths[] = {here, there, nullptr};
    FTS* tree = fts_open(paths, FTS_PHYSICAL, nullptr);
    while (const FTSENT* entry = fts_read(tree)) count_ += entry->fts_path[0] == '/' ? 1 : 0;
    fts_close(tree);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TwoTrees)
