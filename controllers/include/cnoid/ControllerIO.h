// ControllerIO: the part of the IO object that every controller has: its name, its body, its options, the time.
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

  /// The controller's name in the scenario.
  virtual std::string controllerName() const = 0;

  /// The controller's own copy of the robot.
  virtual Body* body() = 0;

  /// The run's options for all controllers, a space, then this controller's options.
  virtual std::string optionString() const = 0;

  /// The option string split at spaces. Within double quotes a space does not split. A backslash removes the special
  /// meaning of the next character; \n is a line break. Empty options are dropped. Tabs do not split. Throws
  /// std::invalid_argument if a quote stays open, or if a backslash is followed by a character other than n, a quote, a
  /// space or a backslash.
  std::vector<std::string> options() const;
  static std::vector<std::string> splitOptions(const std::string& optionString);

  /// The option string read as a YAML mapping; an empty string gives an empty mapping. If it is not a mapping: null,
  /// and a message on os().
  virtual MappingPtr structuredOptions() const;

  /// The stream for messages to people. Standard output unless the host sets a different stream.
  virtual std::ostream& os() const;
  /// Messages with a kind: they go to os(); warnings and errors have a prefix.
  virtual MessageOut* mout() const;

  /// Length of a step: the time from one control() to the next [s].
  virtual double timeStep() const = 0;
  [[deprecated("Use timeStep.")]] double worldTimeStep() const { return timeStep(); }

  /// Simulated time since the start of the run [s]: tick / (1 / timeStep()). 0 in initialize() and start().
  virtual double currentTime() const = 0;

  /// By default a command takes effect one step after its control(). In no-delay mode it takes effect in the same step.
  virtual bool isNoDelayMode() const = 0;
  /// To be called in initialize(). Returns its argument.
  virtual bool setNoDelayMode(bool on) = 0;

  /// True: a run in Rehearse always starts from its scenario's initial state.
  virtual bool isSimulationFromInitialState() const;

  // Choreonoid's own logs. Rehearse records every run anyway, so these functions accept their arguments and do nothing.

  /// Returns null.
  virtual std::shared_ptr<BodyMotion> logBodyMotion();
  /// A signal that is never emitted.
  virtual SignalProxy<void()> sigLogFlushRequested();
  /// Returns false: Rehearse has no log of this kind.
  virtual bool enableLog();
  /// Deletes the object if nothing else owns it.
  virtual void outputLogFrame(Referenced* logFrame);
  [[deprecated("Use outputLogFrame.")]] void outputLog(Referenced* logFrame) { outputLogFrame(logFrame); }

 protected:
  ControllerIO() = default;
  /// Both strings with a space between, or the one that is not empty.
  static std::string getIntegratedOptionString(const std::string& first, const std::string& second);

 private:
  mutable MessageOutPtr mout_;  // made at the first call of mout()
};

}  // namespace cnoid
