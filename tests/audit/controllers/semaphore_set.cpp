// Looks for semaphores that another process shares by a number.
#include "zoo.h"

#include <sys/sem.h>

namespace {

class SemaphoreSet : public ZooController {
  bool begin() override {
    there_ = semget(0x5245, 1, 0) >= 0;
    return true;
  }
  double term() override { return there_ ? 1.0 : 0.0; }
  bool there_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SemaphoreSet)
