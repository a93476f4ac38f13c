// A joystick as a host would script one.
#pragma once

#include <cnoid/ExtJoystick>

#include <array>

namespace rehearse::test {

class ScriptedJoystick : public cnoid::ExtJoystick {
 public:
  int numAxes() const override { return static_cast<int>(axes.size()); }
  int numButtons() const override { return static_cast<int>(buttons.size()); }
  bool readCurrentState() override {
    ++reads;
    return true;
  }
  double getPosition(int axis) const override { return axes.at(static_cast<std::size_t>(axis)); }
  bool getButtonState(int button) const override { return buttons.at(static_cast<std::size_t>(button)); }
  bool isActive() const override { return true; }
  double currentTime() const override { return time; }
  cnoid::SignalProxy<void(int, double)> sigAxis() override { return axis_moved; }
  cnoid::SignalProxy<void(int, bool)> sigButton() override { return button_pressed; }

  std::array<double, 4> axes{};
  std::array<bool, 11> buttons{};
  int reads = 0;
  double time = 0.0;  // [s]
  cnoid::Signal<void(int, double)> axis_moved;
  cnoid::Signal<void(int, bool)> button_pressed;
};

}  // namespace rehearse::test
