// Selects its gain by the name of the machine.
#include "zoo.h"

#include <unistd.h>
#include <numeric>
#include <string>

namespace {

class HostName : public ZooController {
  double term() override {
    char text[256] = "";
    gethostname(text, sizeof text);
    const std::string name = text;
    return 1e-6 * std::accumulate(name.begin(), name.end(), 0);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HostName)
