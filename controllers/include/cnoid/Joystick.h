// Joystick: a controller reads a person's input from it.
//
// It never opens hardware, because input from hardware couldn't be replayed. A Joystick uses the device that its host
// has registered (see ExtJoystick); without a device it has no axes and no buttons, and everything reads zero. This is
// not an error.
#pragma once

#include "Config.h"
#include "JoystickInterface.h"
#include "Signal.h"

#include <string>
#include <vector>

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

  /// Looks for its device at once.
  Joystick();
  /// Uses the device of that name if there is one, else any device.
  explicit Joystick(const char* device);
  Joystick(const Joystick&) = delete;
  Joystick& operator=(const Joystick&) = delete;
  ~Joystick() override;

  std::string device() const { return device_; }
  /// Returns -1: there is no file descriptor.
  int fileDescriptor() const { return -1; }

  /// Looks for a device if none was found before. False if there is none.
  bool makeReady();
  bool isReady() const { return ext_ != nullptr; }
  /// Always empty: a missing joystick is not an error.
  const char* errorMessage() const { return ""; }

  int numAxes() const override;
  int numButtons() const override;
  /// False without a device.
  bool readCurrentState() override;
  /// 0 if the device doesn't have this axis.
  double getPosition(int axis) const override;
  /// False if the device doesn't have this button.
  bool getButtonState(int button) const override;
  bool isActive() const;
  /// A disabled axis reads 0.
  void setAxisEnabled(int axis, bool on);

  /// True if the button is pressed, and wasn't at the readCurrentState() before the last.
  bool getButtonDown(int button) const;
  /// True if the button isn't pressed, and was at the readCurrentState() before the last.
  bool getButtonUp(int button) const;
  /// True if the button has been pressed for longer than the duration [ms] of simulated time.
  bool getButtonHoldOn(int button, int duration) const;
  /// Likewise, but true once for each press.
  bool getButtonHold(int button, int duration) const;

  /// The signal of the device; without a device it is never emitted.
  SignalProxy<void(int id, bool isPressed)> sigButton();
  SignalProxy<void(int id, double position)> sigAxis();

 private:
  struct Button {
    bool isPressed = false, wasPressed = false;  // at the last readCurrentState(), and at the one before
    double since = 0.0;                          // [s]
    mutable bool isHoldTold = false;             // of this press
  };
  /// Null if there was no reading of this button.
  const Button* button(int number) const;

  std::string device_;
  ExtJoystick* ext_ = nullptr;
  ScopedConnection untilDestroyed_;
  std::vector<bool> isAxisOff_;
  std::vector<Button> buttons_;
};

}  // namespace cnoid
