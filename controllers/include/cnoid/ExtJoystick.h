// ExtJoystick: a joystick that no driver provides, registered under a name. Every Joystick that finds one uses it.
//
// This is where a host plugs in its scripted joystick: it registers one before it creates its controllers, since a
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
  /// Leaves the register, and every Joystick that uses it.
  virtual ~ExtJoystick();

  /// Borrows the joystick until it is destroyed. Of two with one name the later counts; a Joystick that has found the
  /// earlier keeps it. Null: the name is free again.
  static void registerJoystick(const std::string& name, ExtJoystick* joystick);
  /// Null if there is none. "*" finds the first in the order of names.
  static ExtJoystick* findJoystick(const std::string& name);

  SignalProxy<void()> sigDestroyed() { return sigDestroyed_; }

  virtual int numAxes() const = 0;
  virtual int numButtons() const = 0;
  virtual bool readCurrentState() = 0;
  /// Asked only for axes and buttons that exist.
  virtual double getPosition(int axis) const = 0;
  virtual bool getButtonState(int button) const = 0;
  /// Whether anybody moves it.
  virtual bool isActive() const = 0;
  virtual SignalProxy<void(int id, double position)> sigAxis() = 0;
  virtual SignalProxy<void(int id, bool isPressed)> sigButton() = 0;

 private:
  Signal<void()> sigDestroyed_;
};

}  // namespace cnoid
