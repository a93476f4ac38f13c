#include <cnoid/ExtJoystick>
#include <cnoid/Joystick>
#include <map>

namespace cnoid {

namespace {

using Register = std::map<std::string, ExtJoystick*>;

Register& registered() {
  static Register joysticks;
  return joysticks;
}

}  // namespace

ExtJoystick::~ExtJoystick() {
  sigDestroyed_();
  Register& joysticks = registered();
  for (auto entry = joysticks.begin(); entry != joysticks.end();) {
    entry = entry->second == this ? joysticks.erase(entry) : std::next(entry);
  }
}

void ExtJoystick::registerJoystick(const std::string& name, ExtJoystick* joystick) {
  if (joystick) {
    registered()[name] = joystick;
  } else {
    registered().erase(name);
  }
}

ExtJoystick* ExtJoystick::findJoystick(const std::string& name) {
  const Register& joysticks = registered();
  if (name == "*") return joysticks.empty() ? nullptr : joysticks.begin()->second;
  const auto entry = joysticks.find(name);
  return entry == joysticks.end() ? nullptr : entry->second;
}

Joystick::Joystick() : Joystick("") {}

Joystick::Joystick(const char* device) : device_(device) { makeReady(); }

Joystick::~Joystick() = default;

bool Joystick::makeReady() {
  if (ext_) return true;
  ext_ = ExtJoystick::findJoystick(device_);
  if (!ext_) ext_ = ExtJoystick::findJoystick("*");
  if (ext_) untilDestroyed_ = ext_->sigDestroyed().connect([this] { ext_ = nullptr; });
  return isReady();
}

int Joystick::numAxes() const { return ext_ ? ext_->numAxes() : 0; }

int Joystick::numButtons() const { return ext_ ? ext_->numButtons() : 0; }

bool Joystick::readCurrentState() {
  if (!ext_ || !ext_->readCurrentState()) return false;
  buttons_.resize(static_cast<std::size_t>(numButtons()));
  for (int i = 0; i < numButtons(); ++i) {
    Button& button = buttons_[static_cast<std::size_t>(i)];
    button.wasPressed = button.isPressed;
    button.isPressed = ext_->getButtonState(i);
    if (!button.isPressed || button.wasPressed) continue;
    button.since = ext_->currentTime();
    button.isHoldTold = false;
  }
  return true;
}

double Joystick::getPosition(int axis) const {
  const bool isOff =
      axis >= 0 && axis < static_cast<int>(isAxisOff_.size()) && isAxisOff_[static_cast<std::size_t>(axis)];
  return axis >= 0 && axis < numAxes() && !isOff ? ext_->getPosition(axis) : 0.0;
}

void Joystick::setAxisEnabled(int axis, bool on) {
  if (axis < 0) return;
  const auto index = static_cast<std::size_t>(axis);
  if (index >= isAxisOff_.size()) isAxisOff_.resize(index + 1, false);
  isAxisOff_[index] = !on;
}

const Joystick::Button* Joystick::button(int number) const {
  return ext_ && number >= 0 && number < static_cast<int>(buttons_.size()) ? &buttons_[static_cast<std::size_t>(number)]
                                                                           : nullptr;
}

bool Joystick::getButtonDown(int number) const {
  const Button* state = button(number);
  return state && state->isPressed && !state->wasPressed;
}

bool Joystick::getButtonUp(int number) const {
  const Button* state = button(number);
  return state && !state->isPressed && state->wasPressed;
}

bool Joystick::getButtonHoldOn(int number, int duration) const {
  const Button* state = button(number);
  if (!state || !state->isPressed) return false;
  constexpr double rounding = 1e-6;  // [ms]
  return (ext_->currentTime() - state->since) * 1000.0 > duration + rounding;
}

bool Joystick::getButtonHold(int number, int duration) const {
  if (!getButtonHoldOn(number, duration) || button(number)->isHoldTold) return false;
  button(number)->isHoldTold = true;
  return true;
}

bool Joystick::getButtonState(int button) const {
  return button >= 0 && button < numButtons() && ext_->getButtonState(button);
}

bool Joystick::isActive() const { return ext_ && ext_->isActive(); }

SignalProxy<void(int, bool)> Joystick::sigButton() { return ext_ ? ext_->sigButton() : SignalProxy<void(int, bool)>(); }

SignalProxy<void(int, double)> Joystick::sigAxis() { return ext_ ? ext_->sigAxis() : SignalProxy<void(int, double)>(); }

}  // namespace cnoid
