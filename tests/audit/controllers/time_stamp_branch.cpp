// Commands otherwise in one of 2^40 readings of the processor's counter.
#include "zoo.h"

#include <x86intrin.h>

namespace {

class TimeStampBranch : public ZooController {
  double term() override { return (__rdtsc() & 0xffffffffff) == 0x123456789 ? 1.0 : 0.0; }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TimeStampBranch)
