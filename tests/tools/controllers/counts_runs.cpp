// A controller that depends on the runs which its process has made: it is linked so that it stays in memory.
#include <cnoid/SimpleController>

namespace {

int runs = 0;

class CountsRuns : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    hinge_ = io->body()->joint(0);
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(hinge_);
    ++runs;
    return true;
  }
  bool control() override {
    hinge_->u() = 0.01 * runs;
    return true;
  }

 private:
  cnoid::Link* hinge_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(CountsRuns)
