// Commands nothing if the disk is full.
#include "zoo.h"

#include <filesystem>

namespace {

class DiskSpace : public ZooController {
  bool begin() override {
    full_ = std::filesystem::space("/").available == 0;
    return true;
  }
  double term() override { return full_ ? 1.0 : 0.0; }
  bool full_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(DiskSpace)
