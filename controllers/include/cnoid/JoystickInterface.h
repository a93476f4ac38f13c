// What a joystick can be asked, whoever plays it.
#pragma once

#include "Config.h"

#include <cmath>

namespace cnoid {

class CNOID_GENERAL_EXPORT JoystickInterface {
 public:
  virtual ~JoystickInterface() = default;
  virtual int numAxes() const = 0;
  virtual int numButtons() const = 0;
  /// Takes over what the device reports now; the questions below answer from it.
  virtual bool readCurrentState() = 0;
  /// Sticks -1 to 1, up and left negative; triggers 0 to 1.
  virtual double getPosition(int axis) const = 0;
  virtual bool getButtonState(int button) const = 0;
};

}  // namespace cnoid
