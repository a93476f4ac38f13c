// JoystickInterface: the state of a joystick, independent of its implementation.
#pragma once

#include "Config.h"

#include <cmath>

namespace cnoid {

class CNOID_GENERAL_EXPORT JoystickInterface {
 public:
  virtual ~JoystickInterface() = default;
  virtual int numAxes() const = 0;
  virtual int numButtons() const = 0;
  /// Reads the current state of the device; the functions below return this state.
  virtual bool readCurrentState() = 0;
  /// Position of an axis: sticks -1 to 1, up and left negative; triggers 0 to 1.
  virtual double getPosition(int axis) const = 0;
  virtual bool getButtonState(int button) const = 0;
};

}  // namespace cnoid
