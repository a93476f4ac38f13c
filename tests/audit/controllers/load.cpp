// Reduces its command if the machine is busy.
#include "zoo.h"

#include <cstdlib>

namespace {

class Load : public ZooController {
  double term() override {
    double load = 0.0;
    getloadavg(&load, 1);
    return -1e-3 * load;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Load)
