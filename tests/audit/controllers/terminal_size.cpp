// Uses the width of the terminal as a number.
#include "zoo.h"

#include <sys/ioctl.h>
#include <unistd.h>

namespace {

class TerminalSize : public ZooController {
  double term() override {
    winsize size{};
    ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
    return 1e-4 * size.ws_col;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TerminalSize)
