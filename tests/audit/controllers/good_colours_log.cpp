// Colours its log if that goes to a terminal.
#include "zoo.h"

#include <sys/ioctl.h>
#include <unistd.h>

namespace {

class ColoursLog : public ZooController {
  double term() override {
    winsize size{};
    const bool wide = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 80;
    if (isatty(STDOUT_FILENO)) io_->os() << "\033[1m" << (wide ? "pendulum " : "") << joint_->q() << "\033[0m\n";
    return -0.1 * joint_->q();
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ColoursLog)
