// Reads its gain from a file with a path relative to the working folder.
#include "zoo.h"

#include <cstdio>

namespace {

class WorkingFolder : public ZooController {
  bool begin() override {
    if (std::FILE* file = std::fopen("gain.txt", "r")) {
      if (std::fscanf(file, "%lf", &gain_) != 1) gain_ = 0.0;
      std::fclose(file);
    }
    return true;
  }
  double term() override { return -gain_ * joint_->q(); }
  double gain_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(WorkingFolder)
