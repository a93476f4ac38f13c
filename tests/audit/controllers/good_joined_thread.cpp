// Computes in threads, and joins them.
#include "zoo.h"

#include <cmath>
#include <thread>

namespace {

class JoinedThread : public ZooController {
  bool begin() override {
    std::thread worker([this] { gain_ = std::sqrt(0.25); });
    worker.join();
    return true;
  }
  double term() override { return -gain_ * joint_->q(); }
  double gain_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(JoinedThread)
