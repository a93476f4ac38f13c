#include "sensor_error.h"

#include <vector>

namespace rehearse {
namespace {

constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double gravity = 9.80665;              // [m/s²], the standard

constexpr Unit turns[] = {{"rad/s"}, {"deg/s", degree}};
constexpr Unit turn_densities[] = {{"rad/s/sqrt(Hz)"}, {"deg/s/sqrt(Hz)", degree}};
constexpr Unit turn_walks[] = {{"rad/s/sqrt(s)"}, {"deg/s/sqrt(s)", degree}};
constexpr Unit accelerations[] = {{"m/s^2"}, {"m/s²"}, {"g", gravity}, {"mg", 1e-3 * gravity}, {"ug", 1e-6 * gravity}};
constexpr Unit acceleration_densities[] = {{"m/s^2/sqrt(Hz)"},
                                           {"m/s²/sqrt(Hz)"},
                                           {"g/sqrt(Hz)", gravity},
                                           {"mg/sqrt(Hz)", 1e-3 * gravity},
                                           {"ug/sqrt(Hz)", 1e-6 * gravity}};
constexpr Unit acceleration_walks[] = {{"m/s^2/sqrt(s)"},
                                       {"m/s²/sqrt(s)"},
                                       {"g/sqrt(s)", gravity},
                                       {"mg/sqrt(s)", 1e-3 * gravity},
                                       {"ug/sqrt(s)", 1e-6 * gravity}};
constexpr Unit fields[] = {{"T"}, {"mT", 1e-3}, {"uT", 1e-6}, {"nT", 1e-9}};
constexpr Unit field_densities[] = {
    {"T/sqrt(Hz)"}, {"mT/sqrt(Hz)", 1e-3}, {"uT/sqrt(Hz)", 1e-6}, {"nT/sqrt(Hz)", 1e-9}};
constexpr Unit field_walks[] = {{"T/sqrt(s)"}, {"mT/sqrt(s)", 1e-3}, {"uT/sqrt(s)", 1e-6}, {"nT/sqrt(s)", 1e-9}};
constexpr Unit forces[] = {{"N"}, {"kN", 1e3}};
constexpr Unit force_densities[] = {{"N/sqrt(Hz)"}};
constexpr Unit force_walks[] = {{"N/sqrt(s)"}};
constexpr Unit torques[] = {{"N·m"}, {"Nm"}, {"N*m"}};
constexpr Unit torque_densities[] = {{"N·m/sqrt(Hz)"}, {"Nm/sqrt(Hz)"}};
constexpr Unit torque_walks[] = {{"N·m/sqrt(s)"}, {"Nm/sqrt(s)"}};
constexpr Unit length_densities[] = {{"m/sqrt(Hz)"}, {"mm/sqrt(Hz)", 1e-3}};
constexpr Unit length_walks[] = {{"m/sqrt(s)"}, {"mm/sqrt(s)", 1e-3}};
constexpr Unit angle_densities[] = {{"rad/sqrt(Hz)"}, {"deg/sqrt(Hz)", degree}};
constexpr Unit angle_walks[] = {{"rad/sqrt(s)"}, {"deg/sqrt(s)", degree}};
constexpr Unit velocities[] = {{"m/s"}, {"mm/s", 1e-3}};
constexpr Unit velocity_densities[] = {{"m/s/sqrt(Hz)"}, {"mm/s/sqrt(Hz)", 1e-3}};
constexpr Unit velocity_walks[] = {{"m/s/sqrt(s)"}, {"mm/s/sqrt(s)", 1e-3}};
constexpr Unit shares[] = {{"%", 0.01}};

/// The units of a quantity, of its density and of its walk.
struct UnitsOfQuantity {
  std::string_view rotational, linear;  // unit of the quantity; of joints those of both types
  std::span<const Unit> plain, density, walk;
};

constexpr UnitsOfQuantity quantities[] = {
    {"rad/s", "", turns, turn_densities, turn_walks},
    {"m/s²", "", accelerations, acceleration_densities, acceleration_walks},
    {"T", "", fields, field_densities, field_walks},
    {"N", "N·m or N", forces, force_densities, force_walks},
    {"N·m", "", torques, torque_densities, torque_walks},
    {"N·m or N", "", torques, torque_densities, torque_walks},
    {"m", "rad or m", length_units, length_densities, length_walks},
    {"rad or m", "", angle_units, angle_densities, angle_walks},
    {"rad/s or m/s", "", turns, turn_densities, turn_walks},
    {"", "rad/s or m/s", velocities, velocity_densities, velocity_walks},
};

}  // namespace

std::span<const Unit> units_of_error(ErrorUnit unit, std::string_view quantity, bool linear) {
  if (unit == ErrorUnit::share) return shares;
  if (unit == ErrorUnit::angle) return angle_units;
  for (const UnitsOfQuantity& each : quantities) {
    if ((linear ? each.linear : each.rotational) != quantity) continue;
    if (unit == ErrorUnit::quantity) return each.plain;
    if (unit == ErrorUnit::per_root_hertz) return each.density;
    if (unit == ErrorUnit::per_root_second) return each.walk;
  }
  return {};
}

std::span<const std::span<const Unit>> all_error_units() {
  static const std::vector<std::span<const Unit>> all = [] {
    std::vector<std::span<const Unit>> lists{shares};
    for (const UnitsOfQuantity& each : quantities) lists.insert(lists.end(), {each.plain, each.density, each.walk});
    return lists;
  }();
  return all;
}

}  // namespace rehearse
