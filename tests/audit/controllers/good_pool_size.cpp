// Reads the number of processors for a thread pool, which it never creates.
#include "zoo.h"

#include <thread>

namespace {

class PoolSize : public ZooController {
  bool begin() override {
    pool_size_ = std::thread::hardware_concurrency();
    return pool_size_ > 0;
  }
  double term() override { return -0.1 * joint_->q(); }
  unsigned pool_size_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PoolSize)
