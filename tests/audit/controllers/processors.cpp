// Divides its gain by the number of processors.
#include "zoo.h"

#include <thread>

namespace {

class Processors : public ZooController {
  double term() override { return -0.1 * joint_->q() / std::thread::hardware_concurrency(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Processors)
