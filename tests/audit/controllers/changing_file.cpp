// Reads its gain from a file, and writes a new one to the file. Its options name the file.
#include "zoo.h"

#include <fstream>

namespace {

class ChangingFile : public ZooController {
  bool begin() override {
    std::ifstream(options()) >> gain_;
    std::ofstream(options()) << gain_ + 0.125 << '\n';
    return true;
  }
  double term() override { return -gain_ * joint_->q(); }
  double gain_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ChangingFile)
