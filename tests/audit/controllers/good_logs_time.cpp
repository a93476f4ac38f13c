// Logs the time; its commands don't depend on it.
#include "zoo.h"

#include <chrono>
#include <ctime>

namespace {

class LogsTime : public ZooController {
  double term() override {
    const auto begin = std::chrono::steady_clock::now();
    const double damping = -0.1 * joint_->q();
    if (++calls_ % 100 == 0)
      io_->os() << std::time(nullptr) << ": it took " << (std::chrono::steady_clock::now() - begin).count() << " ns\n";
    return damping;
  }
  int calls_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LogsTime)
