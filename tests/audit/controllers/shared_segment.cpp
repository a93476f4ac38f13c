// Reads memory that another process shares by a number, if there is any.
#include "zoo.h"

#include <sys/shm.h>

namespace {

class SharedSegment : public ZooController {
  bool begin() override {
    there_ = shmget(0x5245, sizeof(int), 0) >= 0;
    return true;
  }
  double term() override { return there_ ? 1.0 : 0.0; }
  bool there_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SharedSegment)
