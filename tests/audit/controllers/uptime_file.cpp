// Commands by how long the machine runs.
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
