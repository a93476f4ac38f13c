// Its command depends on the user.
#include "zoo.h"

#include <unistd.h>

namespace {

class UserId : public ZooController {
  double term() override { return 1e-6 * getuid(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UserId)
