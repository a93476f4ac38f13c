// Uses its gains after it has freed them, which works only until the memory is used again.
#include "zoo.h"

#include <cstdlib>

namespace {

class UseAfterFree : public ZooController {
  bool begin() override {
    double* gains = static_cast<double*>(std::malloc(64 * sizeof(double)));
    for (int i = 0; i < 64; ++i) gains[i] = 0.01;
    gains_ = gains;
    std::free(gains);
    return true;
  }
  double term() override { return -gains_[40] * joint_->q(); }
  volatile double* gains_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UseAfterFree)
