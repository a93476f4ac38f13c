// A low-pass filter that uses the real elapsed time. It also reads the clock at a second place, only to measure its own
// duration: that value affects no command.
#include "zoo.h"

#include <chrono>

namespace {

using Clock = std::chrono::steady_clock;

class SteadyClock : public ZooController {
  __attribute__((noinline)) double filtered(double value) {
    const Clock::time_point now = Clock::now();
    const double passed = std::chrono::duration<double>(now - last_).count();  // [s]
    last_ = now;
    low_ += (value - low_) * passed / (passed + 0.1);
    return low_;
  }
  __attribute__((noinline)) void count_busy_time() { busy_ = busy_ + (Clock::now() - last_).count(); }
  double term() override {
    const double damping = filtered(-0.1 * joint_->q());
    count_busy_time();
    return damping;
  }

  Clock::time_point last_ = Clock::now();
  double low_ = 0.0;
  volatile long long busy_ = 0;  // [ns]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SteadyClock)
