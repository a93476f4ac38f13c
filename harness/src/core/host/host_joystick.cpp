#include "host_joystick.h"

#include <cnoid/Joystick>
#include <utility>

namespace rehearse {
namespace {

static_assert(joystick_axes.size() == cnoid::Joystick::NUM_STD_AXES);
static_assert(joystick_buttons.size() == cnoid::Joystick::NUM_STD_BUTTONS);

// The name that a Joystick without a name requests; one with an unknown name gets it, too.
constexpr const char* any_name = "";

}  // namespace

bool HostJoystick::readCurrentState() {
  const JoystickReading before = std::exchange(read_, shown_);
  read_at_ = shown_at_;
  for (std::size_t i = 0; i < read_.axes.size(); ++i)
    if (read_.axes[i] != before.axes[i]) axis_moved_(static_cast<int>(i), read_.axes[i]);
  for (std::size_t i = 0; i < read_.buttons.size(); ++i)
    if (read_.buttons[i] != before.buttons[i]) button_changed_(static_cast<int>(i), read_.buttons[i]);
  return true;
}

PluggedIn::PluggedIn(HostJoystick* joystick) : joystick_(joystick) {
  if (joystick_ != nullptr) cnoid::ExtJoystick::registerJoystick(any_name, joystick_);
}

PluggedIn::~PluggedIn() {
  if (joystick_ != nullptr) cnoid::ExtJoystick::registerJoystick(any_name, nullptr);
}

}  // namespace rehearse
