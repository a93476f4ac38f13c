// A thread plans concurrently with the control loop, and the loop uses the latest plan.
#include "zoo.h"

#include <atomic>
#include <thread>

namespace {

class ThreadCommand : public ZooController {
 public:
  ~ThreadCommand() override { end(); }

 private:
  bool begin() override {
    planner_ = std::thread([this] {
      while (!over_) plan_ = plan_ + 1;
    });
    return true;
  }
  double term() override { return 1e-9 * static_cast<double>(plan_.load()); }
  void stop() override { end(); }
  void end() {
    over_ = true;
    if (planner_.joinable()) planner_.join();
  }
  std::atomic<bool> over_{false};
  std::atomic<long> plan_{0};
  std::thread planner_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ThreadCommand)
