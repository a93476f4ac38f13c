// Its command depends on the hash of its thread id.
#include "zoo.h"

#include <functional>
#include <thread>

namespace {

class ThreadHash : public ZooController {
  double term() override { return 1e-6 * (std::hash<std::thread::id>()(std::this_thread::get_id()) % 1000); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ThreadHash)
