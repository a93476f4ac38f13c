// JoystickReading: what a person does with a joystick at one moment, axis by axis and button by button.
//
// It is a gamepad, with the axes and buttons that Choreonoid numbers, in its order.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace rehearse {

inline constexpr std::array<std::string_view, 8> joystick_axes{"L_STICK_H", "L_STICK_V",         "R_STICK_H",
                                                               "R_STICK_V", "DIRECTIONAL_PAD_H", "DIRECTIONAL_PAD_V",
                                                               "L_TRIGGER", "R_TRIGGER"};
inline constexpr std::array<std::string_view, 11> joystick_buttons{"A",      "B",     "X",       "Y",       "L",   "R",
                                                                   "SELECT", "START", "L_STICK", "R_STICK", "LOGO"};

/// Untouched until somebody sets it. Single precision, as ROS carries it: what was recorded is what was read.
struct JoystickReading {
  std::array<float, joystick_axes.size()> axes{};       // -1 to 1, up and left negative; triggers 0 to 1
  std::array<bool, joystick_buttons.size()> buttons{};  // true while pressed

  bool operator==(const JoystickReading&) const = default;
};

/// Where an axis begins; it ends at 1.
constexpr double lowest_position(std::size_t axis) { return joystick_axes[axis].ends_with("_TRIGGER") ? 0.0 : -1.0; }

/// The index of an axis (of joystick_axes) or a button (of joystick_buttons) by its name or its number, "1" or
/// "L_STICK_V"; nullopt if there is none.
template <std::size_t N>
std::optional<std::size_t> find_control(const std::array<std::string_view, N>& names, std::string_view name) {
  for (std::size_t i = 0; i < N; ++i)
    if (name == names[i] || name == std::to_string(i)) return i;
  return std::nullopt;
}

}  // namespace rehearse
