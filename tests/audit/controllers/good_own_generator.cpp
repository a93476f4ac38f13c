// Dithers with its own random generator and a constant seed.
#include "zoo.h"

#include <random>

namespace {

class OwnGenerator : public ZooController {
  double term() override { return 1e-12 * static_cast<double>(generator_()); }
  std::mt19937 generator_{42};
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(OwnGenerator)
