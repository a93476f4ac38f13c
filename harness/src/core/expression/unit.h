// The units of numbers in expressions. Internal.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rehearse {

/// The unit of a sum, a difference, a lesser or a comparison. An empty unit fits all: a number without one, or a series
/// whose unit is unknown. None: the units differ.
std::optional<std::string> common_unit(const std::string& a, const std::string& b);
/// Empty if it isn't the unit of one of the two.
std::string unit_of_product(const std::string& a, const std::string& b);
std::string unit_of_quotient(const std::string& a, const std::string& b);

/// The unit of a series as expressions compare it: empty for quaternions, unit vectors and the like.
std::string comparable_unit(std::string unit);

/// A number with its unit, as messages state it: "6.8 deg". `degrees`: angles in degrees.
std::string quantity_text(double value, const std::string& unit, bool degrees);
/// Two numbers of one unit: "6.8 of 8 deg".
std::string quantities_text(double value, double bound, const std::string& unit, bool degrees);

}  // namespace rehearse
