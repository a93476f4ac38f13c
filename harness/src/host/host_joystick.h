// HostJoystick: the joystick that a controller finds, without knowing where it comes from.
//
// Each controller has one of its own, so that what one reads, or connects to its signals, is no other's matter. All of
// a run's show the same. A cnoid::Joystick keeps what it finds when it is made, or in makeReady(): a controller's is in
// the register while the controller is called, and only then. So no other run in this process can find it.
#pragma once

#include <rehearse/io.h>

#include <cnoid/ExtJoystick>

namespace rehearse {

class HostJoystick final : public cnoid::ExtJoystick {
 public:
  /// What readCurrentState() gives from now on.
  void show(const JoystickReading& reading) { shown_ = reading; }

  int numAxes() const override { return static_cast<int>(read_.axes.size()); }
  int numButtons() const override { return static_cast<int>(read_.buttons.size()); }
  /// Takes over what is shown. Emits sigAxis, then sigButton, for each that isn't what it was at the last call.
  bool readCurrentState() override;
  double getPosition(int axis) const override { return read_.axes.at(static_cast<std::size_t>(axis)); }
  bool getButtonState(int button) const override { return read_.buttons.at(static_cast<std::size_t>(button)); }
  /// Whether anything is moved or pressed.
  bool isActive() const override { return read_ != JoystickReading(); }
  cnoid::SignalProxy<void(int, double)> sigAxis() override { return axis_moved_; }
  cnoid::SignalProxy<void(int, bool)> sigButton() override { return button_changed_; }

 private:
  JoystickReading shown_;
  JoystickReading read_;
  cnoid::Signal<void(int, double)> axis_moved_;
  cnoid::Signal<void(int, bool)> button_changed_;
};

/// Has the joystick in the register as long as this lives; null: none.
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
