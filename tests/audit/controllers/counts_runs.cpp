// Counts its runs in a file in the working folder.
#include "zoo.h"

#include <fstream>

namespace {

class CountsRuns : public ZooController {
  bool begin() override {
    std::ifstream("runs.txt") >> runs_;
    std::ofstream("runs.txt") << ++runs_ << '\n';
    return true;
  }
  double term() override { return 1e-3 * runs_; }
  int runs_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(CountsRuns)
