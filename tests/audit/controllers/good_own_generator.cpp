// Dithers with a generator of its own, from a seed of its own.
#include "zoo.h"

#include <random>

namespace {

class OwnGenerator : public ZooController {
  double term() override { return 1e-12 * static_cast<double>(generator_()); }
  std::mt19937 generator_{42};
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(OwnGenerator)
