// JoystickScript: a joystick that a scenario moves. What it reads is a function of time alone.
#pragma once

#include <rehearse/joystick.h>

#include <array>
#include <cstddef>
#include <vector>

namespace rehearse {

/// Everything rests at 0 and unpressed until it is told otherwise, and stays where it was told to be.
class JoystickScript {
 public:
  /// From the time `at` [s] on, the axis goes in a straight line from where it is to the position `to`, within `over`
  /// [s]; at once if that is 0. A way it is still on ends there. `at` is after that of the axis's last move.
  void move(std::size_t axis, double at, double over, double to);
  /// From the time `at` [s] on, the button is pressed, or not. `at` is after that of the button's last press.
  void press(std::size_t button, double at, bool pressed);

  /// Whether the axis is at that position at a time [s], and not just passing it.
  bool rests(std::size_t axis, double time, double position) const;
  bool is_pressed(std::size_t button, double time) const;

  /// When the axis (the button) was last told anything [s]; below 0 if never.
  double last_move(std::size_t axis) const;
  double last_press(std::size_t button) const;

  /// At a time [s]; positions rounded to the nearest single-precision number.
  JoystickReading at(double time) const;

 private:
  struct Move {
    double at;
    double over;
    double from;
    double to;
  };
  struct Press {
    double at;
    bool pressed;
  };
  double position(std::size_t axis, double time) const;

  // Each in order of time.
  std::array<std::vector<Move>, joystick_axes.size()> moves_;
  std::array<std::vector<Press>, joystick_buttons.size()> presses_;
};

}  // namespace rehearse
