// Sums an array of which only one half is initialised.
#include "zoo.h"

namespace {

class UninitialisedLocal : public ZooController {
  __attribute__((noinline)) double sum() const {
    volatile double samples[32];
    for (int i = 0; i < 16; ++i) samples[i] = 1e-6 * i;
    double total = 0.0;
    for (int i = 0; i < 32; ++i) total += samples[i];
    return total;
  }
  double term() override { return sum(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UninitialisedLocal)
