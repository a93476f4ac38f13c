// Joystick: what a controller reads a person's input from.
//
// No hardware is ever opened: what it would say could not be replayed. A Joystick uses the one that its host has
// registered (see ExtJoystick); without one it has no axes and no buttons, and everything reads zero. That is no error.
#pragma once

#include "Config.h"
#include "JoystickInterface.h"
#include "Signal.h"

#include <string>

namespace cnoid {

class ExtJoystick;

class CNOID_GENERAL_EXPORT Joystick : public JoystickInterface {
 public:
  enum AxisID {
    L_STICK_H_AXIS,
    L_STICK_V_AXIS,
    R_STICK_H_AXIS,
    R_STICK_V_AXIS,
    DIRECTIONAL_PAD_H_AXIS,
    DIRECTIONAL_PAD_V_AXIS,
    L_TRIGGER_AXIS,
    R_TRIGGER_AXIS,
    NUM_STD_AXES
  };
  enum ButtonID {
    A_BUTTON,
    B_BUTTON,
    X_BUTTON,
    Y_BUTTON,
    L_BUTTON,
    R_BUTTON,
    SELECT_BUTTON,
    START_BUTTON,
    L_STICK_BUTTON,
    R_STICK_BUTTON,
    LOGO_BUTTON,
    NUM_STD_BUTTONS
  };

  /// Finds its device at once, if it is there.
  Joystick();
  /// One of that name if there is one, else any.
  explicit Joystick(const char* device);
  Joystick(const Joystick&) = delete;
  Joystick& operator=(const Joystick&) = delete;
  ~Joystick() override;

  std::string device() const { return device_; }
  /// -1: there is no file behind it.
  int fileDescriptor() const { return -1; }

  /// Looks for a device if it has none. False if there is none.
  bool makeReady();
  bool isReady() const { return ext_ != nullptr; }
  /// Empty: a missing joystick is no error.
  const char* errorMessage() const { return ""; }

  int numAxes() const override;
  int numButtons() const override;
  /// False without a device.
  bool readCurrentState() override;
  /// 0 for an axis that the device has not.
  double getPosition(int axis) const override;
  /// False for a button that the device has not.
  bool getButtonState(int button) const override;
  bool isActive() const;

  /// Of the device; without one: never emitted.
  SignalProxy<void(int id, bool isPressed)> sigButton();
  SignalProxy<void(int id, double position)> sigAxis();

 private:
  std::string device_;
  ExtJoystick* ext_ = nullptr;
  ScopedConnection untilDestroyed_;
};

}  // namespace cnoid
