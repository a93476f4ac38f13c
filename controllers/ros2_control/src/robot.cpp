#include "robot.h"

#include <rehearse_variable.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rehearse_ros2_control {
namespace {

struct QuantityRow {
  const char* interface;
  int quantity;
  bool is_command;
};
constexpr QuantityRow quantities[] = {{"position", REHEARSE_Q, true},
                                      {"velocity", REHEARSE_DQ, true},
                                      {"acceleration", REHEARSE_DDQ, false},
                                      {"effort", REHEARSE_U, true}};

/// Numbers of devices, in the order in which <rehearse/controller.h> copies them.
struct DeviceRow {
  const char* type;
  std::vector<const char*> interfaces;
};
const std::vector<DeviceRow>& devices() {
  static const std::vector<DeviceRow> rows{
      {"ForceSensor", {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"}},
      {"RateGyroSensor", {"angular_velocity.x", "angular_velocity.y", "angular_velocity.z"}},
      {"AccelerationSensor", {"linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"}},
      {"Imu",
       {"linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z", "angular_velocity.x",
        "angular_velocity.y", "angular_velocity.z"}}};
  return rows;
}

const QuantityRow* quantity_named(const std::string& interface) {
  const auto* const row = std::find_if(std::begin(quantities), std::end(quantities),
                                       [&](const QuantityRow& known) { return interface == known.interface; });
  return row == std::end(quantities) ? nullptr : row;
}

template <class Values>
std::size_t index_of(const Values& values, const std::string& name) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const auto& value) { return value.name == name; });
  return found == values.end() ? Robot::none : static_cast<std::size_t>(found - values.begin());
}

}  // namespace

Robot*& Robot::being_made() {
  static Robot* robot = nullptr;
  return robot;
}

void Robot::check(int code) const {
  if (code < 0) throw std::runtime_error(rehearse_error(io_));
}

std::size_t Robot::state(const std::string& part, const std::string& interface) {
  const std::string name = part + "/" + interface;
  if (const std::size_t known = index_of(states_, name); known != none) return known;
  State state;
  state.name = name;
  state.handle = rehearse_joint(io_, part.c_str());
  if (state.handle >= 0) {
    const QuantityRow* const row = quantity_named(interface);
    if (row == nullptr) return none;
    state.quantity = row->quantity;
    check(rehearse_read(io_, state.handle, state.quantity));
    state.value = rehearse_get(io_, state.handle, state.quantity);
  } else {
    state.handle = rehearse_device(io_, part.c_str());
    if (state.handle < 0) return none;
    const std::string type = rehearse_device_type(io_, state.handle);
    for (const DeviceRow& row : devices())
      for (std::size_t i = 0; type == row.type && i < row.interfaces.size(); ++i)
        if (interface == row.interfaces[i]) state.element = static_cast<int>(i);
    if (state.element < 0) return none;
    check(rehearse_read_device(io_, state.handle));
  }
  states_.push_back(state);
  return states_.size() - 1;
}

std::size_t Robot::command(const std::string& joint, const std::string& interface) {
  const std::string name = joint + "/" + interface;
  if (const std::size_t known = index_of(commands_, name); known != none) return known;
  const QuantityRow* const row = quantity_named(interface);
  Command command;
  command.name = name;
  command.handle = rehearse_joint(io_, joint.c_str());
  if (command.handle < 0 || row == nullptr || !row->is_command) return none;
  command.quantity = row->quantity;
  commands_.push_back(command);
  return commands_.size() - 1;
}

void Robot::claim(const std::vector<std::string>& names, bool is_claimed) {
  for (const std::string& name : names) {
    const std::size_t known = index_of(commands_, name);
    if (known == none) continue;
    commands_[known].is_claimed = is_claimed;
    commands_[known].had_number = false;
  }
}

void Robot::choose_drives(const std::string& controller, const std::vector<std::string>& claimed) {
  for (const std::string& name : claimed) {
    const std::size_t known = index_of(commands_, name);
    if (known == none) continue;
    const Command& command = commands_[known];
    auto drive =
        std::find_if(drives_.begin(), drives_.end(), [&](const Drive& other) { return other.joint == command.handle; });
    if (drive == drives_.end()) drive = drives_.insert(drive, {command.handle, 0, controller});
    if (drive->controller != controller && (drive->quantities & command.quantity) == 0)
      throw std::runtime_error("'" + controller + "' claims '" + name + "', but '" + drive->controller +
                               "' commands another quantity of this joint: in a run it has one");
    drive->quantities |= command.quantity;
  }
  for (const Drive& drive : drives_) check(rehearse_command(io_, drive.joint, drive.quantities));
}

void Robot::read() {
  std::array<double, 6> numbers{};
  for (State& state : states_) {
    if (state.element < 0) {
      state.value = rehearse_get(io_, state.handle, state.quantity);
    } else {
      rehearse_device_numbers(io_, state.handle, numbers.data(), static_cast<int>(numbers.size()));
      state.value = numbers[static_cast<std::size_t>(state.element)];
    }
  }
}

Robot::BadCommand Robot::write() {
  for (Command& command : commands_) {
    if (!command.is_claimed) continue;
    if (!std::isfinite(command.value)) {
      if (std::isnan(command.value) && !command.had_number) continue;
      return {command.name, "commands " + std::to_string(command.value) + " to '" + command.name + "'"};
    }
    command.had_number = true;
    const bool is_driven = std::any_of(drives_.begin(), drives_.end(), [&](const Drive& drive) {
      return drive.joint == command.handle && (drive.quantities & command.quantity) != 0;
    });
    if (!is_driven)
      return {command.name, "commands '" + command.name + "', and wasn't named in the options of the run"};
    check(rehearse_set(io_, command.handle, command.quantity, command.value));
  }
  return {};
}

void Robot::record() const {
  for (const State& state : states_) rehearse_variable(("state/" + state.name).c_str(), state.value);
  for (const Command& command : commands_)
    if (command.is_claimed) rehearse_variable(("command/" + command.name).c_str(), command.value);
}

}  // namespace rehearse_ros2_control
