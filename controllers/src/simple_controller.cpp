#include <cnoid/SimpleController>

namespace cnoid {

SimpleControllerIO::~SimpleControllerIO() = default;

void SimpleControllerIO::setJointInput(int stateFlags) {
  for (Link* joint : body()->joints()) {
    if (joint->isValid()) enableInput(joint, stateFlags);
  }
}

void SimpleControllerIO::setJointOutput(int stateFlags) {
  for (Link* joint : body()->joints()) {
    if (joint->isValid()) enableOutput(joint, stateFlags);
  }
}

void SimpleControllerIO::setLinkInput(Link* link, int stateFlags) { enableInput(link, stateFlags); }

void SimpleControllerIO::setLinkOutput(Link* link, int stateFlags) { enableOutput(link, stateFlags); }

SimulationSimpleControllerIO::~SimulationSimpleControllerIO() = default;

bool SimulationSimpleControllerIO::isImmediateMode() const { return isNoDelayMode(); }

void SimulationSimpleControllerIO::setImmediateMode(bool on) { setNoDelayMode(on); }

SimpleControllerConfig::SimpleControllerConfig(SimpleControllerIO* io) : io_(io) {}

SimpleControllerConfig::~SimpleControllerConfig() = default;

std::string SimpleControllerConfig::controllerName() const { return io_->controllerName(); }

Body* SimpleControllerConfig::body() { return io_->body(); }

std::string SimpleControllerConfig::optionString() const { return io_->optionString(); }

std::vector<std::string> SimpleControllerConfig::options() const { return ControllerIO::splitOptions(optionString()); }

std::ostream& SimpleControllerConfig::os() const { return io_->os(); }

Referenced* SimpleControllerConfig::bodyItem() { return nullptr; }

SimpleController::SimpleController() = default;

SimpleController::~SimpleController() = default;

bool SimpleController::configure(SimpleControllerConfig*) { return true; }

bool SimpleController::initialize(SimpleControllerIO*) { return true; }

bool SimpleController::start() { return true; }

bool SimpleController::control() { return false; }

void SimpleController::stop() {}

void SimpleController::pause() {}

bool SimpleController::resume() { return true; }

void SimpleController::unconfigure() {}

}  // namespace cnoid
