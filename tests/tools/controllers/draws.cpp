// A controller that draws from rand() and never calls srand(): it repeats itself in each process anew.
#include <cnoid/SimpleController>
#include <cstdlib>

namespace {

class Draws : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    hinge_ = io->body()->joint(0);
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(hinge_);
    return true;
  }
  bool control() override {
    hinge_->u() = 0.01 * std::rand() / RAND_MAX;
    return true;
  }

 private:
  cnoid::Link* hinge_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Draws)
