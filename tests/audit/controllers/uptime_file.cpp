// Its command depends on the uptime of the machine.
#include "zoo.h"

#include <fstream>

namespace {

class UptimeFile : public ZooController {
  double term() override {
    double uptime = 0.0;
    std::ifstream("/proc/uptime") >> uptime;
    return 1e-6 * uptime;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UptimeFile)
