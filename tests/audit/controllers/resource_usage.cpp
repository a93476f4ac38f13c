// Its command depends on the memory that the process has used.
#include "zoo.h"

#include <sys/resource.h>

namespace {

class ResourceUsage : public ZooController {
  double term() override {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1e-9 * (usage.ru_maxrss + usage.ru_minflt);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ResourceUsage)
