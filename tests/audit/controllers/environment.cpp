// Takes a setting from the environment.
#include "zoo.h"

#include <cstdlib>
#include <cstring>

namespace {

class Environment : public ZooController {
  bool begin() override {
    const char* home = std::getenv("HOME");
    stiffness_ = 0.001 * static_cast<double>(home ? std::strlen(home) : 0);
    return true;
  }
  double term() override { return -stiffness_ * joint_->q(); }
  double stiffness_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Environment)
