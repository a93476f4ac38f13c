#include "unit.h"

#include <fmt/format.h>
#include <rehearse/units.h>

namespace rehearse {
namespace {

double in_shown_unit(double value, const std::string& unit, bool degrees) {
  return degrees && unit.starts_with("rad") ? value / units::degree : value;
}

std::string shown_unit(const std::string& unit, bool degrees) {
  if (unit.empty()) return {};
  return " " + (degrees && unit.starts_with("rad") ? "deg" + unit.substr(3) : unit);
}

}  // namespace

std::optional<std::string> common_unit(const std::string& a, const std::string& b) {
  if (a.empty() || a == b) return b;
  return b.empty() ? std::optional(a) : std::nullopt;
}

std::string unit_of_product(const std::string& a, const std::string& b) {
  if (a.empty()) return b;
  return b.empty() ? a : std::string();
}

std::string unit_of_quotient(const std::string& a, const std::string& b) { return b.empty() ? a : std::string(); }

std::string comparable_unit(std::string unit) {
  const Unit* row = find_unit(unit);
  return row && row->is_unnamed ? "" : unit;
}

std::string quantity_text(double value, const std::string& unit, bool degrees) {
  return fmt::format("{:.6g}{}", in_shown_unit(value, unit, degrees), shown_unit(unit, degrees));
}

std::string quantities_text(double value, double bound, const std::string& unit, bool degrees) {
  return fmt::format("{:.6g} of {:.6g}{}", in_shown_unit(value, unit, degrees), in_shown_unit(bound, unit, degrees),
                     shown_unit(unit, degrees));
}

}  // namespace rehearse
