// Sums whole numbers in as many threads as there are processors; the sum doesn't depend on the order.
#include "zoo.h"

#include <atomic>
#include <thread>
#include <vector>

namespace {

class ThreadPool : public ZooController {
  double term() override {
    std::atomic<int> sum = 0;
    std::atomic<int> next = 0;
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
      threads.emplace_back([&] {
        for (int number = next++; number < 100; number = next++) sum += number;
      });
    for (std::thread& thread : threads) thread.join();
    return 1e-6 * sum;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ThreadPool)
