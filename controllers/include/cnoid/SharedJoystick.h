// SharedJoystick: one joystick for a controller and its child controllers, which use it in turn.
//
// Obtained by io->getOrCreateSharedObject<SharedJoystick>("joystick"). Each user gets a mode from addMode(), calls
// updateState(its mode) every step, and passes its mode to the reading functions: they return zeros while a different
// mode is active. The LOGO or the SELECT button switches to the next mode. Only the user with mode 0 polls the device.
#pragma once

#include "Joystick.h"
#include "Referenced.h"

#include <cmath>

namespace cnoid {

class CNOID_GENERAL_EXPORT SharedJoystick : public Referenced {
 public:
  static constexpr Joystick::ButtonID MODE_BUTTON1 = Joystick::LOGO_BUTTON;
  static constexpr Joystick::ButtonID MODE_BUTTON2 = Joystick::SELECT_BUTTON;

  /// Replaces the default device; the new device must outlive this object.
  void setJoystick(JoystickInterface* joystick) { joystick_ = joystick; }

  /// Adds a mode; the first is 0.
  int addMode() { return numModes_++; }
  int mode() const { return mode_; }
  bool isMode(int mode) const { return mode_ == mode; }
  void setMode(int mode) { mode_ = mode; }

  /// With mode 0: polls the device, and switches to the next mode if a mode button was just pressed. With other modes:
  /// does nothing.
  void updateState(int mode) {
    if (mode != 0) return;
    const bool isPressed = getModeButtonState();
    if (isPressed && !wasPressed_) mode_ = mode_ + 1 < numModes_ ? mode_ + 1 : 0;
    wasPressed_ = isPressed;
  }
  /// Polls the device.
  bool getModeButtonState() {
    joystick_->readCurrentState();
    return joystick_->getButtonState(MODE_BUTTON1) || joystick_->getButtonState(MODE_BUTTON2);
  }

  /// Position of an axis; 0 if its magnitude is below the threshold. With two whole numbers the first is a mode: write
  /// the threshold with a decimal point.
  double getPosition(int axis, double threshold = 0.0) const {
    const double position = joystick_->getPosition(axis);
    return std::fabs(position) >= threshold ? position : 0.0;
  }
  double getPosition(int mode, int axis, double threshold = 0.0) const {
    return isMode(mode) ? getPosition(axis, threshold) : 0.0;
  }
  bool getButtonState(int button) const { return joystick_->getButtonState(button); }
  bool getButtonState(int mode, int button) const { return isMode(mode) && getButtonState(button); }

 private:
  Joystick defaultJoystick_;
  JoystickInterface* joystick_ = &defaultJoystick_;
  int mode_ = 0;
  int numModes_ = 0;
  bool wasPressed_ = false;
};

using SharedJoystickPtr = ref_ptr<SharedJoystick>;

}  // namespace cnoid
