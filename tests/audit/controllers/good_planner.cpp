// A thread plans when it is asked to, and the loop uses the latest plan. It reads a clock, too.
#include "zoo.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace {

using Clock = std::chrono::steady_clock;

class Planner : public ZooController {
 public:
  ~Planner() override { end(); }

 private:
  bool begin() override {
    planner_ = std::thread([this] {
      std::unique_lock lock(mutex_);
      for (;;) {
        woken_.wait(lock, [this] { return over_ || asked_; });
        if (over_) return;
        asked_ = false;
        plan_ = 0.1 * plan_ + std::chrono::duration<double>(Clock::now() - begin_).count();
      }
    });
    return true;
  }
  double term() override {
    const std::scoped_lock lock(mutex_);
    asked_ = true;
    woken_.notify_one();
    return 1e-3 * plan_;
  }
  void stop() override { end(); }
  void end() {
    {
      const std::scoped_lock lock(mutex_);
      over_ = true;
    }
    woken_.notify_one();
    if (planner_.joinable()) planner_.join();
  }

  std::mutex mutex_;
  std::condition_variable woken_;
  bool asked_ = false, over_ = false;
  double plan_ = 0.0;
  Clock::time_point begin_ = Clock::now();
  std::thread planner_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Planner)
