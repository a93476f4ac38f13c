// ControllerIO: what any controller is given to know: its name, its body, its options, the time.
//
// The harness implements it; a controller only calls it, and may keep the pointer from initialize() to the end of the
// run.
#pragma once

#include "Body.h"
#include "Config.h"
#include "MessageOut.h"
#include "Signal.h"
#include "ValueTree.h"

#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace cnoid {

class BodyMotion;

class CNOID_GENERAL_EXPORT ControllerIO {
 public:
  virtual ~ControllerIO();

  /// The name in the scenario.
  virtual std::string controllerName() const = 0;

  /// The controller's own copy of the robot.
  virtual Body* body() = 0;

  /// The run's options for all controllers, a space, this controller's options.
  virtual std::string optionString() const = 0;

  /// The option string split at spaces. Within double quotes a space does not split. A backslash makes the next
  /// character a plain one; \n is a line break. Empty options are dropped. Tabs do not split. Throws
  /// std::invalid_argument if a quote stays open, or if a backslash is followed by anything but n, a quote, a space or
  /// a backslash.
  std::vector<std::string> options() const;
  static std::vector<std::string> splitOptions(const std::string& optionString);

  /// The option string read as a YAML mapping; an empty one gives an empty mapping. If it is something else: null, and
  /// a message on os().
  virtual MappingPtr structuredOptions() const;

  /// For messages to people. Standard output unless the host gives another.
  virtual std::ostream& os() const;
  /// The same with warnings and errors marked as such: they go to os() with a word before them.
  virtual MessageOut* mout() const;

  /// From one control() to the next [s].
  virtual double timeStep() const = 0;
  [[deprecated("Use timeStep.")]] double worldTimeStep() const { return timeStep(); }

  /// Since the start of the run [s]: tick / (1 / timeStep()). 0 in initialize() and start().
  virtual double currentTime() const = 0;

  /// By default a command acts one step after the control() that gave it. In no-delay mode it acts in the same step.
  virtual bool isNoDelayMode() const = 0;
  /// To be called in initialize(). Returns its argument.
  virtual bool setNoDelayMode(bool on) = 0;

  /// True: a run here always starts from its scenario's initial state.
  virtual bool isSimulationFromInitialState() const;

  // Choreonoid's own logs. A run is recorded here anyway, so these are accepted and do nothing.

  /// Null.
  virtual std::shared_ptr<BodyMotion> logBodyMotion();
  /// Never emitted.
  virtual SignalProxy<void()> sigLogFlushRequested();
  /// False: there is no such log.
  virtual bool enableLog();
  /// Takes the object over, and forgets it.
  virtual void outputLogFrame(Referenced* logFrame);
  [[deprecated("Use outputLogFrame.")]] void outputLog(Referenced* logFrame) { outputLogFrame(logFrame); }

 protected:
  ControllerIO() = default;
  /// The two with a space between, or the one that is not empty.
  static std::string getIntegratedOptionString(const std::string& first, const std::string& second);

 private:
  mutable MessageOutPtr mout_;  // made when it is first asked for
};

}  // namespace cnoid
