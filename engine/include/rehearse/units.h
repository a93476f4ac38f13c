// The registry of units: a row for each unit in which channels, devices and errors state numbers.
//
// A row has the name of the unit in recordings, the difference that checks allow by default, and the spellings that
// scenarios, expressions and noise accept after a number. All else about units is read from the rows. A unit without a
// row, or a row without a tolerance, doesn't compile.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rehearse {

/// Where a spelling is accepted.
enum class SpeltIn { all_files, noise };

/// A unit as it is written after a number: the number times the factor is in the unit of the row.
struct Spelling {
  std::string_view text = {};
  double factor = 1.0;
  SpeltIn where = SpeltIn::all_files;
};

/// The difference of two numbers that a check allows if no rule states another one. It has no default.
struct UnitTolerance {
  consteval UnitTolerance(double absolute, double relative, double share = 0.0, double delta = 0.0)
      : atol(absolute), rtol(relative), pixel_share(share), pixel_delta(delta) {}

  double atol;         // in the unit
  double rtol;         // share of the golden's number
  double pixel_share;  // of pictures: share of the pixels that may be beyond the tolerance
  double pixel_delta;  // of pictures: difference of a pixel [of 255]
};

struct Unit {
  std::string_view name;
  UnitTolerance tolerance;
  std::array<Spelling, 5> spellings = {};  // those without a text don't exist
  std::string_view shown = {};             // in sentences; empty: the name
  bool is_unnamed = false;                 // expressions compare its numbers with numbers without a unit

  constexpr std::span<const Spelling> all_spellings() const {
    std::size_t count = 0;
    while (count < spellings.size() && !spellings[count].text.empty()) ++count;
    return std::span(spellings).first(count);
  }
};

namespace units {

inline constexpr double degree = 0.017453292519943295;  // [rad]
inline constexpr double gravity = 9.80665;              // [m/s²], the standard
inline constexpr UnitTolerance exact{0.0, 0.0};
inline constexpr double edges = 0.0005;  // share of the pixels
/// Of a field of 50 µT, as the directions of the same step differ by less than 1e-9 rad: a millionth of a µT.
inline constexpr UnitTolerance field{1e-12, 0.0};

inline constexpr Unit rows[] = {
    {"", exact, {{{"%", 0.01, SpeltIn::noise}}}},
    {"rad", {1e-9, 0.0}, {{{"rad"}, {"deg", degree}, {"mrad", 1e-3}}}},
    {"m", {1e-9, 0.0}, {{{"m"}, {"mm", 1e-3}, {"cm", 1e-2}}}},
    {"s", exact, {{{"s"}, {"ms", 1e-3}, {"us", 1e-6}}}},
    {"N", {1e-4, 0.0}, {{{"N"}, {"kN", 1e3}}}},
    {"N·m", {1e-3, 0.0}, {{{"N·m"}, {"Nm"}, {"N*m"}}}},
    {"rad/s", {1e-7, 0.0}, {{{"rad/s"}, {"deg/s", degree}}}},
    {"m/s", {1e-7, 0.0}, {{{"m/s"}, {"mm/s", 1e-3}}}},
    {"rad/s²", {1e-4, 0.0}, {{{"rad/s^2"}, {"rad/s²"}, {"deg/s^2", degree}, {"deg/s²", degree}}}},
    {"m/s²",
     {1e-4, 0.0},
     {{{"m/s^2"},
       {"m/s²"},
       {"g", gravity, SpeltIn::noise},
       {"mg", 1e-3 * gravity, SpeltIn::noise},
       {"ug", 1e-6 * gravity, SpeltIn::noise}}}},
    {"T", field, {{{"T"}, {"mT", 1e-3}, {"uT", 1e-6}, {"nT", 1e-9}}}},
    {"Hz", exact, {{{"Hz"}, {"kHz", 1e3}}}},
    {"kg", exact, {{{"kg"}, {"g", 1e-3}}}},
    {"W", exact, {{{"W"}}}},
    {"J", exact, {{{"J"}}}},
    {"V", exact, {{{"V"}}}},
    {"A", exact, {{{"A"}}}},
    {"Pa", exact, {{{"Pa"}}}},
    {"K", exact, {{{"K"}}}},
    {"px", exact, {{{"px"}}}},
    {"B", exact},
    {"ticks", exact},
    {"of 255", exact},
    {.name = "quaternion", .tolerance = {1e-9, 0.0}, .is_unnamed = true},
    {.name = "unit vector", .tolerance = {1e-9, 0.0}, .is_unnamed = true},
    {"pixels", {0.0, 0.0, edges, 2.0}},
    // Quantities whose numbers aren't judged as others of their unit.
    {.name = "float32 distance", .tolerance = {1e-9, 0x1p-23}, .shown = "m"},          // the ranges of a scan
    {.name = "distance in a picture", .tolerance = {0.0, 1e-3, edges}, .shown = "m"},  // of a depth picture
    {"figure of a camera", {1e-9, 0.0}},                                               // of a CameraInfo
};

}  // namespace units

/// Null: there is no such row.
constexpr const Unit* find_unit(std::string_view name) {
  for (const Unit& unit : units::rows)
    if (unit.name == name) return &unit;
  return nullptr;
}

/// The name of a unit of the registry; another name doesn't compile. It has the number of the row, because programs and
/// libraries may each have a copy of the rows.
class UnitName {
 public:
  constexpr UnitName() = default;
  consteval UnitName(const char* name) {
    const Unit* row = find_unit(name);
    if (row == nullptr) throw "rehearse/units.h has no row for this unit";
    number_ = static_cast<std::size_t>(row - units::rows);
  }

  constexpr std::size_t number() const { return number_; }
  constexpr const Unit& row() const { return units::rows[number_]; }
  constexpr std::string_view name() const { return row().name; }
  constexpr operator std::string_view() const { return name(); }
  constexpr bool empty() const { return name().empty(); }
  constexpr std::span<const Spelling> spellings() const { return row().all_spellings(); }
  friend constexpr bool operator==(const UnitName&, const UnitName&) = default;

 private:
  std::size_t number_ = 0;
};

/// The units of an error that depends on how often a quantity is measured.
enum class DensityPer {
  root_hertz,   // white noise: "m/s²/sqrt(Hz)"
  root_second,  // a random walk: "m/s²/sqrt(s)"
};
/// The spellings of a unit's density: each of the unit's own, divided by a root.
std::span<const Spelling> density_spellings(UnitName unit, DensityPer per);

/// The factor of one of these spellings; nullopt: the text is none of them.
std::optional<double> factor_in(std::span<const Spelling> spellings, std::string_view text);

/// The factor of a spelling of any unit or density; nullopt: there is no such spelling.
std::optional<double> factor_of_spelling(std::string_view text);

/// A unit at the beginning of a text in an expression.
struct WrittenUnit {
  std::string_view text;  // "deg"
  std::string_view unit;  // in which recordings have such a quantity: "rad"
  double scale = 1.0;     // of one written unit, in `unit`
};
/// The longest unit at the beginning of the text that ends where a word ends; nullopt: there is none.
std::optional<WrittenUnit> leading_unit(std::string_view text);
/// "rad, deg, m, ...": all units that may follow a number in an expression.
std::string known_units();

/// The unit as sentences state it: "m" for all distances. A unit without a row is stated as it is.
std::string_view shown_unit(std::string_view unit);

}  // namespace rehearse
