// ExtJoystick: a joystick implemented in software, registered under a name. Every Joystick that finds one uses it.
//
// A host provides its scripted joystick through this class: it registers one before it creates its controllers, since a
// Joystick is usually a member that looks for its device when it is constructed.
#pragma once

#include "Config.h"
#include "Signal.h"

#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT ExtJoystick {
 public:
  ExtJoystick() = default;
  ExtJoystick(const ExtJoystick&) = delete;
  ExtJoystick& operator=(const ExtJoystick&) = delete;
  /// Removes the joystick from the register and from every Joystick that uses it.
  virtual ~ExtJoystick();

  /// Registers the joystick, without owning it, until it is destroyed. Of two with one name the later one is used; a
  /// Joystick that has found the earlier one keeps it. Null removes the name from the register.
  static void registerJoystick(const std::string& name, ExtJoystick* joystick);
  /// Null if there is no joystick of that name. "*" finds the first in the order of names.
  static ExtJoystick* findJoystick(const std::string& name);

  SignalProxy<void()> sigDestroyed() { return sigDestroyed_; }

  virtual int numAxes() const = 0;
  virtual int numButtons() const = 0;
  virtual bool readCurrentState() = 0;
  /// Called only with axes and buttons that exist.
  virtual double getPosition(int axis) const = 0;
  virtual bool getButtonState(int button) const = 0;
  /// True if the joystick is in use.
  virtual bool isActive() const = 0;
  /// The time of the state that readCurrentState() has read, from any beginning [s].
  virtual double currentTime() const { return 0.0; }
  virtual SignalProxy<void(int id, double position)> sigAxis() = 0;
  virtual SignalProxy<void(int id, bool isPressed)> sigButton() = 0;

 private:
  Signal<void()> sigDestroyed_;
};

}  // namespace cnoid
