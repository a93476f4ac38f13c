// Holds the knees with a strength that a library of its own states.
#include <cnoid/SimpleController>

extern "C" double strength();  // of the gain

namespace {

class Linked : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (const char* name : {"RLEG_KNEE", "LLEG_KNEE"}) {
      cnoid::Link* knee = io->body()->link(name);
      knee->setActuationMode(cnoid::Link::JointEffort);
      io->enableIO(knee);
    }
    io_ = io;
    return true;
  }

  bool control() override {
    for (const char* name : {"RLEG_KNEE", "LLEG_KNEE"}) {
      cnoid::Link* knee = io_->body()->link(name);
      knee->u() = strength() * 100.0 * (0.1 - knee->q());
    }
    return true;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Linked)
