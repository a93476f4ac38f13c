// SR1MinimumController whose commands differ by 1 % at one joint, from half a second before the end of ten on.
#include <cnoid/SimpleController>

#pragma push_macro("CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY")
#undef CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY
#define CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(controller)
#include "SR1MinimumController.cpp"
#pragma pop_macro("CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY")

namespace {

class Sr1DiffersLate final : public SR1MinimumController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    knee_ = io->body()->joint("RLEG_KNEE");
    return SR1MinimumController::initialize(io);
  }

  bool control() override {
    const bool result = SR1MinimumController::control();
    if (tick_++ >= 9500) knee_->u() *= 1.01;
    return result;
  }

 private:
  cnoid::Link* knee_ = nullptr;
  long tick_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Sr1DiffersLate)
