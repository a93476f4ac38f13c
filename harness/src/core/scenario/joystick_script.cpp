#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <algorithm>

namespace rehearse {
namespace {

constexpr double never = -1.0;  // [s]: earlier than all times of a run

/// The last change that began at or before the time; null if there is none.
template <class Change>
const Change* latest(const std::vector<Change>& changes, double time) {
  const auto after = std::upper_bound(changes.begin(), changes.end(), time,
                                      [](double moment, const Change& change) { return moment < change.at; });
  return after == changes.begin() ? nullptr : &*(after - 1);
}

}  // namespace

void JoystickScript::move(std::size_t axis, double at, double over, double to) {
  REHEARSE_ASSERT(at > last_move(axis), "moves of an axis come in order of time");
  const double from = position(axis, at);
  moves_[axis].push_back({at, over, from, to});
}

void JoystickScript::press(std::size_t button, double at, bool pressed) {
  REHEARSE_ASSERT(at > last_press(button), "presses of a button come in order of time");
  presses_[button].push_back({at, pressed});
}

bool JoystickScript::rests(std::size_t axis, double time, double where) const {
  const Move* move = latest(moves_[axis], time);
  if (move == nullptr) return where == 0.0;
  return move->to == where && time - move->at >= move->over;
}

bool JoystickScript::is_pressed(std::size_t button, double time) const {
  const Press* press = latest(presses_[button], time);
  return press != nullptr && press->pressed;
}

double JoystickScript::last_move(std::size_t axis) const {
  return moves_[axis].empty() ? never : moves_[axis].back().at;
}

double JoystickScript::last_press(std::size_t button) const {
  return presses_[button].empty() ? never : presses_[button].back().at;
}

double JoystickScript::position(std::size_t axis, double time) const {
  const Move* move = latest(moves_[axis], time);
  if (move == nullptr) return 0.0;
  const double since = time - move->at;
  return since < move->over ? move->from + (move->to - move->from) * (since / move->over) : move->to;
}

JoystickReading JoystickScript::at(double time) const {
  JoystickReading reading;
  for (std::size_t i = 0; i < reading.axes.size(); ++i) reading.axes[i] = static_cast<float>(position(i, time));
  for (std::size_t i = 0; i < reading.buttons.size(); ++i) reading.buttons[i] = is_pressed(i, time);
  return reading;
}

}  // namespace rehearse
