// Reduces its stiffness if its output is a terminal.
#include "zoo.h"

#include <unistd.h>

namespace {

class Terminal : public ZooController {
  double term() override { return isatty(STDOUT_FILENO) ? 0.1 * joint_->q() : 0.0; }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Terminal)
