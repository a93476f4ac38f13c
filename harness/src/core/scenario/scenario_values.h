// Typed values from YAML nodes. Every reader either returns a value or reports to Findings the present value and the
// expected ones.
//
// Numbers are read by std::from_chars: no locale, no octal, no infinities or NaN. Text in quotes is never a number.
#pragma once

#include "core/form/form.h"
#include "scenario_findings.h"
#include "yaml/yaml_tree.h"

#include <rehearse/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rehearse {

// Outside of these ranges no double-precision simulation is meaningful; the ranges also keep every product in it
// finite.
inline constexpr Range any_position{-1e6, 1e6, "[m]"};
inline constexpr Range any_length{1e-6, 1e6, "[m]"};
inline constexpr Range any_mass{1e-9, 1e9, "[kg]"};
inline constexpr Range any_friction{0.0, 1e6};
inline constexpr Range any_restitution{0.0, 1.0};
inline constexpr Range any_force{-1e9, 1e9, "[N]"};
inline constexpr Range any_torque{-1e9, 1e9, "[N·m]"};
inline constexpr Range any_acceleration{-1e6, 1e6, "[m/s²]"};
inline constexpr Range any_velocity{-1e6, 1e6, "[m/s]"};
inline constexpr Range any_angular_velocity{-1e6, 1e6, "[rad/s]"};
inline constexpr Range any_angle{-1e6, 1e6, "[rad]"};

/// The user's text for a message: on one line, of about `longest` bytes at most, never cut inside a UTF-8 sequence.
std::string shortened(std::string_view text, std::size_t longest = 60);

/// A description of the node for a message: "a list", "empty", "'ten'", "-1".
std::string describe(const YamlNode& node);

/// Reports the present value of `label` and the expected one. All messages on values have this form.
void expected(Findings& findings, const YamlNode& node, std::string_view label, std::string_view what);

/// The longest prefix of `text` that is a number; `rest` is the text after it.
std::optional<double> leading_number(std::string_view text, std::string_view& rest);

std::optional<double> read_number(Findings& findings, const YamlNode& node, std::string_view label, const Range& range);
std::optional<std::int64_t> read_integer(Findings& findings, const YamlNode& node, std::string_view label,
                                         std::int64_t low, std::int64_t high);
/// Any scalar, as written; empty text only in quotes.
std::optional<std::string> read_text(Findings& findings, const YamlNode& node, std::string_view label,
                                     std::string_view what = "text");
/// A name that is valid in a channel name: no '/', blanks, control characters or the globs' * ? [ ]; at most 100 bytes.
std::optional<std::string> read_name(Findings& findings, const YamlNode& node, std::string_view label);
std::optional<bool> read_flag(Findings& findings, const YamlNode& node, std::string_view label);
/// Above 0 [Hz]; the unit is optional.
std::optional<double> read_rate(Findings& findings, const YamlNode& node, std::string_view label);
/// [rad]
std::optional<double> read_angle(Findings& findings, const YamlNode& node, std::string_view label);
// A number may be written with a unit of a list; the value is in the unit of the registry's row.
inline constexpr std::span<const Spelling> time_units = UnitName("s").spellings();
inline constexpr std::span<const Spelling> rate_units = UnitName("Hz").spellings();
inline constexpr std::span<const Spelling> angle_units = UnitName("rad").spellings();
inline constexpr std::span<const Spelling> length_units = UnitName("m").spellings();
/// A number without a unit, or with one of these.
std::optional<double> read_quantity(Findings& findings, const YamlNode& node, std::string_view label,
                                    std::span<const Spelling> units, const Range& range);
/// A number whose unit is known only later, or an angle with its unit as 10 deg or 0.1 rad.
struct Measure {
  double value = 0.0;    // angles in [rad]
  bool angle = false;    // it has a unit of an angle
  bool degrees = false;  // this unit is deg
};
/// A time as 0.5, 0.5 s or 20 ms [s].
std::optional<double> read_seconds(Findings& findings, const YamlNode& node, std::string_view label,
                                   const Range& range);
std::optional<Measure> read_measure(Findings& findings, const YamlNode& node, std::string_view label);
/// A list of `least` to `most` numbers.
std::optional<std::vector<double>> read_numbers(Findings& findings, const YamlNode& node, std::string_view label,
                                                std::size_t least, std::size_t most, const Range& range);
std::optional<Eigen::Vector3d> read_vector3(Findings& findings, const YamlNode& node, std::string_view label,
                                            const Range& range);
/// [roll, pitch, yaw] about fixed axes, {axis, angle}, or {quaternion: [w, x, y, z]}; gives a unit quaternion.
std::optional<Eigen::Quaterniond> read_rotation(Findings& findings, const YamlNode& node, std::string_view label);
/// The elements, at most 1000; none if it isn't a list, or is longer.
std::span<const YamlNodePtr> read_list(Findings& findings, const YamlNode& node, std::string_view label,
                                       std::string_view what);

/// The entries of a map in document order, each key once; reports keys that aren't words, and duplicates.
struct NamedEntry {
  std::string name;
  const YamlNode* key;
  const YamlNode* value;
};
std::vector<NamedEntry> read_entries(Findings& findings, const YamlNode& map);

/// The value of the first such key of a map, or null.
const YamlNode* find_key(const YamlNode& map, std::string_view key);

/// The words for the values of an enumeration or of a flag. `what` describes them in messages.
template <class Value>
struct Words {
  std::string_view what;
  std::vector<std::pair<std::string_view, Value>> all;

  std::vector<std::string> names() const {
    std::vector<std::string> texts;
    for (const auto& [word, value] : all) texts.emplace_back(word);
    return texts;
  }
  /// Empty: the value has no word.
  std::string name_of(const Value& value) const {
    const auto known = std::ranges::find_if(all, [&](const auto& each) { return each.second == value; });
    return std::string(known == all.end() ? std::string_view() : known->first);
  }
};

// A value as it would be written: one element, or those of a list. None: nothing could be written in its place.
using Written = std::vector<std::string>;
Written written(double value);
Written written(float value);
Written written(int value);
Written written(std::uint32_t value);
Written written(bool value);
Written written(const std::string& value);
Written written(const Eigen::Vector3d& value);
Written written(const Eigen::Vector3f& value);
template <class Value>
Written written(const std::optional<Value>& value) {
  return value ? written(*value) : Written();
}
/// A default as it would be written; none: the key can't state this value.
template <class Value>
Written written_default(const ValueType& type, const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    if (!type.range.contains(value)) return {};
  return written(value);
}
/// "0.4", "[0, 0, 1]"; empty: there is no element.
std::string one_text(const Written& elements);

/// A map with a fixed set of keys. The constructor reports nodes that are no map, unknown keys and duplicate keys.
class Keys {
 public:
  /// `form` stays referenced.
  Keys(Findings& findings, const YamlNode& node, const Form& form);

  bool is_map() const { return node_.kind == YamlNode::Kind::map; }
  /// The value, or null if the key is missing, or unknown to the form and so reported already.
  const YamlNode* find(std::string_view key) const;
  /// The value, or null if the key is missing. Reports a missing key, unless an unknown key was taken for it. `what`
  /// describes the expected value.
  const YamlNode* require(std::string_view key, std::string_view what) const;

  /// All entries in document order, each key once, unknown ones included.
  const std::vector<NamedEntry>& entries() const { return entries_; }
  /// True if an unknown key was reported.
  bool has_unknown() const { return has_unknown_; }

  // Each reads a key into `out`, and leaves `out` unchanged if the key is missing or its value is wrong. Of a missing
  // key, `out` is the default. The form has the range, and the units if there are some.
  void read(std::string_view key, double& out) const;
  void read(std::string_view key, float& out) const;
  void read(std::string_view key, std::optional<double>& out) const;
  void read(std::string_view key, int& out) const;
  void read(std::string_view key, std::uint32_t& out) const;
  void read(std::string_view key, std::optional<int>& out) const;
  void read(std::string_view key, std::string& out) const;
  void read(std::string_view key, bool& out) const;
  void read(std::string_view key, std::optional<bool>& out) const;
  void read(std::string_view key, Eigen::Vector3d& out) const;
  void read(std::string_view key, Eigen::Vector3f& out) const;
  /// As Findings::absent_map().
  const YamlNode& absent_map(const std::string& key) const { return findings_.absent_map(node_, key); }
  /// States the default of a missing key that is read in another way. It is that of the form, if the form has one.
  void set_default(std::string_view key, std::vector<std::string> elements) const;
  template <class Value>
  void read(std::string_view key, const Words<std::type_identity_t<Value>>& words, Value& out) const {
    const YamlNode* node = find(key);
    REHEARSE_ASSERT(row(key).type.words == words.names(), "the form has the words that are read");
    if (node == nullptr) {
      if (std::string name = words.name_of(out); !name.empty()) set_default(key, {std::move(name)});
      return;
    }
    for (const auto& [word, value] : words.all) {
      if (node->kind != YamlNode::Kind::scalar || node->text != word) continue;
      out = value;
      return;
    }
    expected(findings_, *node, key, words.what);
  }

 private:
  const FormKey& row(std::string_view key) const;
  const Range& range_of(std::string_view key) const;
  std::optional<double> number(std::string_view key, const YamlNode& node) const;
  std::optional<std::int64_t> whole(std::string_view key, const YamlNode& node) const;
  /// Reads a stated value by a function of the node; else states the default.
  template <class Value, class Read>
  void take(std::string_view key, Value& out, Read&& read_stated) const;

  Findings& findings_;
  const YamlNode& node_;
  const Form& form_;
  std::vector<NamedEntry> entries_;
  std::vector<std::string> misspelt_;  // the known keys that unknown ones resemble
  bool has_unknown_ = false;
};

}  // namespace rehearse
