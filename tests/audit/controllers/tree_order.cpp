// Goes by the order in which fts_read() finds the entries of a folder.
#include "zoo.h"

#include <fts.h>

namespace {

class TreeOrder : public ZooController {
  bool begin() override {
    std::string folder = options();
    folder.resize(folder.rfind('/'));
    char* const paths[] = {folder.data(), nullptr};
    FTS* tree = fts_open(paths, FTS_PHYSICAL, nullptr);
    while (FTSENT* entry = fts_read(tree)) order_ = 0.5 * order_ + entry->fts_name[0];
    fts_close(tree);
    return true;
  }
  double term() override { return 1e-9 * order_; }
  double order_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TreeOrder)
