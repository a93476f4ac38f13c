// Dithers with rand().
#include "zoo.h"

#include <cstdlib>

namespace {

class Rand : public ZooController {
  double term() override { return 1e-12 * std::rand(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Rand)
