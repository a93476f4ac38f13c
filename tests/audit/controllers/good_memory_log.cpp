// Logs the memory of the process.
#include "zoo.h"

#include <fstream>

namespace {

class MemoryLog : public ZooController {
  double term() override {
    std::string pages;
    std::ifstream("/proc/self/stat") >> pages;
    io_->os() << pages << '\n';
    return -0.1 * joint_->q();
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(MemoryLog)
