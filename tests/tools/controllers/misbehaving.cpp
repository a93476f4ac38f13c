// A controller that does what its options say, as "crash 12": what, and in which call of control(); without a number in
// initialize(). Knows: refuse, throw, crash, abort, exit, close, overflow, hang, nan, chance.
#include <cmath>
#include <cnoid/SimpleController>
#include <cstdlib>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

namespace {

volatile bool deeper = true;

/// Never ends, and the compiler neither knows that nor can make a loop of it.
int sink(volatile char* above) {
  volatile char here[4096];
  here[0] = above[0];
  return deeper ? sink(here) + here[0] : 0;
}

class Misbehaving : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::istringstream words(io->optionString());
    words >> deed_;
    if (!(words >> when_)) when_ = -1;
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointTorque);
    io->enableIO(joint_);
    if (when_ < 0) misbehave();
    return deed_ != "refuse";
  }

  bool control() override {
    joint_->u() = -1.0 * joint_->q();
    if (calls_++ == when_) misbehave();
    return true;
  }

 private:
  void misbehave() {
    if (deed_ == "throw") throw std::runtime_error("no gait for this slope");
    if (deed_ == "crash") missing_->u() = 1.0;
    if (deed_ == "abort") std::abort();
    if (deed_ == "exit") std::exit(0);
    if (deed_ == "close")
      for (int descriptor = 1; descriptor < 1024; ++descriptor) close(descriptor);
    if (deed_ == "nan") joint_->u() = std::nan("");
    if (deed_ == "chance") joint_->u() = 1e-9 * std::random_device()();
    if (deed_ == "overflow") {
      volatile char bottom = 0;
      sink(&bottom);
    }
    if (deed_ == "hang") {
      for (volatile bool forever = true; forever;) {
      }
    }
  }

  std::string deed_;
  int when_ = -1;
  int calls_ = 0;
  cnoid::Link* joint_ = nullptr;
  cnoid::Link* volatile missing_ = nullptr;  // as of a misspelt name that nobody checked
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Misbehaving)
