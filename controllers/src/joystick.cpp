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

bool Joystick::readCurrentState() { return ext_ && ext_->readCurrentState(); }

double Joystick::getPosition(int axis) const { return axis >= 0 && axis < numAxes() ? ext_->getPosition(axis) : 0.0; }

bool Joystick::getButtonState(int button) const {
  return button >= 0 && button < numButtons() && ext_->getButtonState(button);
}

bool Joystick::isActive() const { return ext_ && ext_->isActive(); }

SignalProxy<void(int, bool)> Joystick::sigButton() { return ext_ ? ext_->sigButton() : SignalProxy<void(int, bool)>(); }

SignalProxy<void(int, double)> Joystick::sigAxis() { return ext_ ? ext_->sigAxis() : SignalProxy<void(int, double)>(); }

}  // namespace cnoid
