// Increases its command in odd seconds of the day.
#include "zoo.h"

#include <ctime>

namespace {

class Time : public ZooController {
  double term() override { return 1e-3 * static_cast<double>(std::time(nullptr) % 60); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Time)
