// A spring made of software: it pulls a sliding mass back with its stiffness times the displacement.
//
// By default a command takes effect one step after its control(). A spring that is one step late pulls too hard on the
// way in and too little on the way out, so that each swing gains energy. In no-delay mode the force belongs to the
// displacement of the same step, and the amplitude stays constant.
//
// Options: "{stiffness: 80}" [N/m]; with "late: true" the default mode stays on, to show the difference.

#include <cnoid/SimpleController>

namespace {

class SpringController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    slide_ = io->body()->joint("SLIDE");
    const cnoid::MappingPtr options = io->structuredOptions();
    if (!slide_ || !options || !options->read("stiffness", stiffness_)) {
      io->os() << io->controllerName() << " needs a joint SLIDE, and its stiffness [N/m] as an option\n";
      return false;
    }
    io->setNoDelayMode(!options->get("late", false));
    slide_->setActuationMode(JointForce);
    io->enableIO(slide_);
    return true;
  }

  bool control() override {
    slide_->u() = -stiffness_ * slide_->q();
    return true;
  }

 private:
  cnoid::Link* slide_ = nullptr;
  double stiffness_ = 0.0;  // [N/m]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SpringController)
