// Reduces its command if the machine is busy; reads the load from the kernel's file.
#include "zoo.h"

#include <fstream>

namespace {

class LoadFile : public ZooController {
  bool begin() override {
    std::ifstream("/proc/loadavg") >> load_;
    return true;
  }
  double term() override { return -1e-3 * load_; }
  double load_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LoadFile)
