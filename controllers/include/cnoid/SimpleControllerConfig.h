// SimpleControllerConfig: the argument of configure(), before the simulation exists.
//
// Its body is the loaded model, not the copy that initialize() provides. Options are those of the controller, without
// those of the run.
#pragma once

#include "SimpleControllerIO.h"

#include <ostream>
#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT SimpleControllerConfig {
 public:
  /// Returns data of `io`, which must outlive this object. A host may override the functions instead.
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

  /// Returns null: there is no graphical interface.
  virtual Referenced* bodyItem();
  /// Never emitted: nothing changes between configure() and initialize().
  SignalProxy<void()> sigChanged() { return sigChanged_; }

 private:
  SimpleControllerIO* io_;
  Signal<void()> sigChanged_;
};

}  // namespace cnoid
