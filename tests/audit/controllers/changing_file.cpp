// Learns its gain: reads it from a file, and writes a better one. Its options name the file.
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
