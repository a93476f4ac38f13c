// Logs the user, the machine, the process, and the machine's load.
#include "zoo.h"

#include <sys/utsname.h>
#include <unistd.h>
#include <cstdlib>

namespace {

class LogsMachine : public ZooController {
  bool begin() override {
    char name[256] = "";
    gethostname(name, sizeof name);
    utsname system{};
    uname(&system);
    double load = 0.0;
    getloadavg(&load, 1);
    io_->os() << name << ' ' << system.release << ' ' << getuid() << ' ' << getpid() << ' ' << load << std::endl;
    return true;
  }
  double term() override { return -0.1 * joint_->q(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LogsMachine)
