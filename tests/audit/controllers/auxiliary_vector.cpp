// Asks the kernel for the processor's features.
#include "zoo.h"

#include <sys/auxv.h>

namespace {

class AuxiliaryVector : public ZooController {
  double term() override { return 1e-12 * static_cast<double>(getauxval(AT_HWCAP) & 0xffff); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(AuxiliaryVector)
