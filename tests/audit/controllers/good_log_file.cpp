// Writes a log to a file. Its options name the file.
#include "zoo.h"

#include <fstream>

namespace {

class LogFile : public ZooController {
  bool begin() override {
    log_.open(options(), std::ios::app);
    log_ << "a run begins\n";
    return true;
  }
  double term() override {
    log_ << joint_->q() << '\n';
    return -0.1 * joint_->q();
  }
  std::ofstream log_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LogFile)
