// Measures time without the system, by the processor's counter.
#include "zoo.h"

#include <x86intrin.h>

namespace {

class TimeStampCounter : public ZooController {
  double term() override { return 1e-12 * static_cast<double>(__rdtsc() % 1000003); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TimeStampCounter)
