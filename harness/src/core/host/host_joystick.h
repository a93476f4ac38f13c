// HostJoystick: the joystick of a controller, independent of its source.
//
// Each controller has a separate object, so that reads and signal connections of one controller don't affect others.
// All objects of a run show the same reading. A cnoid::Joystick keeps the joystick that it finds when it is created, or
// in makeReady(). So a controller's joystick is registered only while the controller is called, and no other run in
// this process can find it.
#pragma once

#include <rehearse/io.h>

#include <cnoid/ExtJoystick>

namespace rehearse {

class HostJoystick final : public cnoid::ExtJoystick {
 public:
  /// Sets the reading that readCurrentState() gives from now on, and its time [s].
  void show(const JoystickReading& reading, double time) {
    shown_ = reading;
    shown_at_ = time;
  }

  int numAxes() const override { return static_cast<int>(read_.axes.size()); }
  int numButtons() const override { return static_cast<int>(read_.buttons.size()); }
  /// Reads the shown state. Emits sigAxis, then sigButton, for each value that has changed since the last call.
  bool readCurrentState() override;
  double getPosition(int axis) const override { return read_.axes.at(static_cast<std::size_t>(axis)); }
  bool getButtonState(int button) const override { return read_.buttons.at(static_cast<std::size_t>(button)); }
  /// True if any axis is moved or any button is pressed.
  bool isActive() const override { return read_ != JoystickReading(); }
  double currentTime() const override { return read_at_; }
  cnoid::SignalProxy<void(int, double)> sigAxis() override { return axis_moved_; }
  cnoid::SignalProxy<void(int, bool)> sigButton() override { return button_changed_; }

 private:
  JoystickReading shown_;
  JoystickReading read_;
  double shown_at_ = 0.0, read_at_ = 0.0;  // [s]
  cnoid::Signal<void(int, double)> axis_moved_;
  cnoid::Signal<void(int, bool)> button_changed_;
};

/// Registers the joystick during its lifetime; null: none.
class PluggedIn {
 public:
  explicit PluggedIn(HostJoystick* joystick);
  ~PluggedIn();
  PluggedIn(const PluggedIn&) = delete;
  PluggedIn& operator=(const PluggedIn&) = delete;

 private:
  HostJoystick* joystick_;
};

}  // namespace rehearse
