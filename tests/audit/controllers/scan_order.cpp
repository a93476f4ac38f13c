// Goes by the order in which scandir() finds the entries of a folder.
#include "zoo.h"

#include <dirent.h>

namespace {

class ScanOrder : public ZooController {
  bool begin() override {
    const std::string path = options();
    dirent** entries = nullptr;
    const int count = scandir(path.substr(0, path.rfind('/')).c_str(), &entries, nullptr, nullptr);
    for (int i = 0; i < count; ++i) order_ = 0.5 * order_ + entries[i]->d_name[0];
    return true;
  }
  double term() override { return 1e-9 * order_; }
  double order_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScanOrder)
