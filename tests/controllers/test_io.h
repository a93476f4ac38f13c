// The IO object that these tests give to a controller: it records enabled quantities, and copies no data itself.
#pragma once

#include <cnoid/SimpleController>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rehearse::test {

class TestIO : public cnoid::SimulationSimpleControllerIO {
 public:
  explicit TestIO(cnoid::Body* body) : body_(body) {}

  std::string controllerName() const override { return "tested"; }
  cnoid::Body* body() override { return body_; }
  std::string optionString() const override { return options_text; }
  std::ostream& os() const override { return messages; }
  double timeStep() const override { return 0.001; }
  double currentTime() const override { return time; }
  bool isNoDelayMode() const override { return no_delay; }
  bool setNoDelayMode(bool on) override { return no_delay = on; }

  void enableIO(cnoid::Link* link) override {
    enableInput(link);
    enableOutput(link);
  }
  void enableInput(cnoid::Link* link) override { enableInput(link, cnoid::Link::JointDisplacement); }
  void enableInput(cnoid::Link* link, int state_flags) override { inputs[checked(link).name()] |= state_flags; }
  void enableInput(cnoid::Device* device) override { device_inputs.insert(device->name()); }
  void enableOutput(cnoid::Link* link) override { outputs.insert(checked(link).name()); }
  void enableOutput(cnoid::Link* link, int state_flags) override {
    checked(link).setActuationMode(static_cast<short>(state_flags));
    if (state_flags) enableOutput(link);
  }

  std::string options_text;
  mutable std::ostringstream messages;
  double time = 0.0;  // [s]
  bool no_delay = false;
  std::map<std::string, int> inputs;  // link name, flags
  std::set<std::string> outputs;      // link names
  std::set<std::string> device_inputs;

 private:
  static cnoid::Link& checked(cnoid::Link* link) {
    if (!link) throw std::invalid_argument("a null link can't be enabled");
    return *link;
  }

  cnoid::BodyPtr body_;
};

}  // namespace rehearse::test
