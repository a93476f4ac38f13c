// SimpleControllerConfig: what a controller is given in configure(), before there is a simulation.
//
// Its body is the model as loaded, not the copy that initialize() will give. Options are the controller's own, without
// those of the run.
#pragma once

#include "SimpleControllerIO.h"

#include <ostream>
#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT SimpleControllerConfig {
 public:
  /// Answers from `io`, which must live longer. A host may override instead.
  explicit SimpleControllerConfig(SimpleControllerIO* io);
  SimpleControllerConfig(const SimpleControllerConfig&) = delete;
  SimpleControllerConfig& operator=(const SimpleControllerConfig&) = delete;
  virtual ~SimpleControllerConfig();

  virtual std::string controllerName() const;
  virtual Body* body();
  virtual std::string optionString() const;
  /// See ControllerIO::options().
  std::vector<std::string> options() const;
  virtual std::ostream& os() const;

  /// Null: there is no graphical interface.
  virtual Referenced* bodyItem();
  /// Never emitted: nothing changes between configure() and initialize().
  SignalProxy<void()> sigChanged() { return sigChanged_; }

 private:
  SimpleControllerIO* io_;
  Signal<void()> sigChanged_;
};

}  // namespace cnoid
