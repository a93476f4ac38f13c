#include "unit.h"

#include <fmt/format.h>

#include <array>
#include <numbers>

namespace rehearse {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

constexpr std::array<WrittenUnit, 32> units{{{"deg", "rad", degree},
                                             {"rad", "rad", 1.0},
                                             {"m", "m", 1.0},
                                             {"cm", "m", 1e-2},
                                             {"mm", "m", 1e-3},
                                             {"s", "s", 1.0},
                                             {"ms", "s", 1e-3},
                                             {"N", "N", 1.0},
                                             {"kN", "N", 1e3},
                                             {"N·m", "N·m", 1.0},
                                             {"N*m", "N·m", 1.0},
                                             {"Nm", "N·m", 1.0},
                                             {"deg/s", "rad/s", degree},
                                             {"rad/s", "rad/s", 1.0},
                                             {"m/s", "m/s", 1.0},
                                             {"mm/s", "m/s", 1e-3},
                                             {"deg/s²", "rad/s²", degree},
                                             {"deg/s^2", "rad/s²", degree},
                                             {"rad/s²", "rad/s²", 1.0},
                                             {"rad/s^2", "rad/s²", 1.0},
                                             {"m/s²", "m/s²", 1.0},
                                             {"m/s^2", "m/s²", 1.0},
                                             {"kg", "kg", 1.0},
                                             {"g", "kg", 1e-3},
                                             {"Hz", "Hz", 1.0},
                                             {"W", "W", 1.0},
                                             {"J", "J", 1.0},
                                             {"V", "V", 1.0},
                                             {"A", "A", 1.0},
                                             {"Pa", "Pa", 1.0},
                                             {"K", "K", 1.0},
                                             {"px", "px", 1.0}}};

bool is_of_a_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '^' ||
         static_cast<unsigned char>(c) >= 0x80;
}

double in_shown_unit(double value, const std::string& unit, bool degrees) {
  return degrees && unit.starts_with("rad") ? value / degree : value;
}

std::string shown_unit(const std::string& unit, bool degrees) {
  if (unit.empty()) return {};
  return " " + (degrees && unit.starts_with("rad") ? "deg" + unit.substr(3) : unit);
}

}  // namespace

const WrittenUnit* leading_unit(std::string_view text) {
  const WrittenUnit* found = nullptr;
  for (const WrittenUnit& unit : units) {
    if (!text.starts_with(unit.text) || (found && found->text.size() > unit.text.size())) continue;
    const std::string_view rest = text.substr(unit.text.size());
    if (rest.empty() || !is_of_a_word(rest.front())) found = &unit;
  }
  return found;
}

std::string known_units() {
  std::string text;
  for (const WrittenUnit& unit : units) text += fmt::format("{}{}", text.empty() ? "" : ", ", unit.text);
  return text;
}

std::optional<std::string> common_unit(const std::string& a, const std::string& b) {
  if (a.empty() || a == b) return b;
  return b.empty() ? std::optional(a) : std::nullopt;
}

std::string unit_of_product(const std::string& a, const std::string& b) {
  if (a.empty()) return b;
  return b.empty() ? a : std::string();
}

std::string unit_of_quotient(const std::string& a, const std::string& b) { return b.empty() ? a : std::string(); }

std::string comparable_unit(std::string unit) { return unit == "quaternion" || unit == "unit vector" ? "" : unit; }

std::string quantity_text(double value, const std::string& unit, bool degrees) {
  return fmt::format("{:.6g}{}", in_shown_unit(value, unit, degrees), shown_unit(unit, degrees));
}

std::string quantities_text(double value, double bound, const std::string& unit, bool degrees) {
  return fmt::format("{:.6g} of {:.6g}{}", in_shown_unit(value, unit, degrees), in_shown_unit(bound, unit, degrees),
                     shown_unit(unit, degrees));
}

}  // namespace rehearse
