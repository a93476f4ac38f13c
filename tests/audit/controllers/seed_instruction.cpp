// Commands otherwise for one of 2^40 random numbers of the processor.
#include "zoo.h"

#include <immintrin.h>

namespace {

class SeedInstruction : public ZooController {
  __attribute__((target("rdseed"))) double term() override {
    unsigned long long number = 0;
    _rdseed64_step(&number);
    return (number & 0xffffffffff) == 0x123456789 ? 1.0 : 0.0;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SeedInstruction)
