// Draws its random numbers from the processor.
#include "zoo.h"

#include <immintrin.h>

namespace {

class RandomInstruction : public ZooController {
  __attribute__((target("rdrnd"))) double term() override {
    unsigned long long number = 0;
    _rdrand64_step(&number);
    return 1e-9 * static_cast<double>(number % 1000003);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RandomInstruction)
