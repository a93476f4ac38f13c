// Reads its gain from a file that never changes. Its options name the file.
#include "zoo.h"

#include <cstdlib>
#include <fstream>

namespace {

class ConstantFile : public ZooController {
  bool begin() override {
    if (!std::getenv("HOME")) io_->os() << "nobody is at home\n";
    return static_cast<bool>(std::ifstream(options()) >> gain_);
  }
  double term() override { return -gain_ * joint_->q(); }
  double gain_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ConstantFile)
