// Reads its dither from the machine's random device.
#include "zoo.h"

#include <random>

namespace {

class RandomDevice : public ZooController {
  double term() override { return 1e-12 * device_(); }
  std::random_device device_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RandomDevice)
