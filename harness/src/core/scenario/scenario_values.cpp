#include "scenario_values.h"

#include "scenario_forms.h"

#include "base/names.h"
#include "base/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <system_error>

namespace rehearse {

std::optional<double> leading_number(std::string_view text, std::string_view& rest) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || !std::isfinite(value)) return std::nullopt;
  rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return value;
}

namespace {

std::optional<double> plain_number(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar || node.quoted) return std::nullopt;
  std::string_view rest;
  const std::optional<double> value = leading_number(node.text, rest);
  return rest.empty() ? value : std::nullopt;
}

// A bare number, or one with a unit. In quotes only with its unit, because many people would write "10 deg".
std::optional<double> number_with_unit(const YamlNode& node, std::string_view& unit) {
  const auto number = node.kind == YamlNode::Kind::scalar ? leading_number(node.text, unit) : std::nullopt;
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  return number && unit.empty() && node.quoted ? std::nullopt : number;
}

std::optional<Measure> number_or_angle(const YamlNode& node) {
  std::string_view unit;
  const auto number = number_with_unit(node, unit);
  if (!number) return std::nullopt;
  if (unit.empty()) return Measure{*number};
  // recordings have the bits of this product, which isn't always that with the factor of the registry
  if (unit == "deg") return Measure{*number * std::numbers::pi / 180.0, true, true};
  const auto factor = factor_in(angle_units, unit);
  return factor ? std::optional(Measure{*number * *factor, true}) : std::nullopt;
}

std::string element(std::string_view label, std::size_t index) { return fmt::format("{}[{}]", label, index); }

std::optional<Eigen::Quaterniond> unit_quaternion(Findings& findings, const YamlNode& node) {
  const auto w_x_y_z = read_numbers(findings, node, "quaternion", 4, 4, Range{-1e6, 1e6});
  if (!w_x_y_z) return std::nullopt;
  const Eigen::Quaterniond read((*w_x_y_z)[0], (*w_x_y_z)[1], (*w_x_y_z)[2], (*w_x_y_z)[3]);
  if (read.norm() < 1e-6) {
    findings.error(node, "quaternion is zero", "[w, x, y, z] of any length but 0; no rotation is [1, 0, 0, 0]");
    return std::nullopt;
  }
  return read.normalized();
}

std::optional<Eigen::Quaterniond> axis_and_angle(Findings& findings, const YamlNode& axis_node,
                                                 const YamlNode& angle_node) {
  const auto axis = read_vector3(findings, axis_node, "axis", Range{-1e6, 1e6});
  const auto angle = read_angle(findings, angle_node, "angle");
  if (axis && axis->norm() < 1e-6) {
    findings.error(axis_node, "axis is zero", "[x, y, z] of any length but 0");
    return std::nullopt;
  }
  if (!axis || !angle) return std::nullopt;
  return Eigen::Quaterniond(Eigen::AngleAxisd(*angle, axis->normalized()));
}

// R = Rz(yaw) Ry(pitch) Rx(roll), as in URDF.
std::optional<Eigen::Quaterniond> roll_pitch_yaw(Findings& findings, const YamlNode& node, std::string_view label) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (const auto angle = read_angle(findings, *node.items[i], element(label, i))) angles.push_back(*angle);
  }
  if (angles.size() != 3) return std::nullopt;
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return Eigen::Quaterniond(AngleAxisd(angles[2], Vector3d::UnitZ()) * AngleAxisd(angles[1], Vector3d::UnitY()) *
                            AngleAxisd(angles[0], Vector3d::UnitX()))
      .normalized();
}

bool has_word(std::string_view text, std::string_view word) {
  const auto is_letter = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_');
  };
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1))
    if ((at == 0 || !is_letter(at - 1)) && !is_letter(at + word.size())) return true;
  return false;
}

/// The near names, and after them the keys whose texts have the unknown one as a word: "coulomb", dry friction in
/// motion, for "friction".
std::vector<std::string> with_described(std::vector<std::string> near, const Form& form, const std::string& unknown) {
  constexpr std::size_t most = 3, shortest = 4;
  if (unknown.size() < shortest) return near;
  for (const FormKey& key : form.keys) {
    const bool described = has_word(key.text, unknown);
    if (described && near.size() < most && std::ranges::find(near, key.name) == near.end()) near.emplace_back(key.name);
  }
  return near;
}

}  // namespace

std::string shortened(std::string_view text, std::size_t longest) {
  std::string result;
  for (const char c : text) {
    if (result.size() >= longest && (static_cast<unsigned char>(c) & 0xC0u) != 0x80u) return result + "...";
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return result;
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::empty: return "empty";
    case YamlNode::Kind::list: return "a list";
    case YamlNode::Kind::map: return "a map";
    case YamlNode::Kind::scalar: break;
  }
  if (plain_number(node)) return shortened(node.text);
  return fmt::format("{}'{}'", node.quoted ? "the text " : "", shortened(node.text));
}

void expected(Findings& findings, const YamlNode& node, std::string_view label, std::string_view what) {
  findings.error(node, fmt::format("{} is {}", label, describe(node)), fmt::format("expected {}", what));
}

std::optional<double> read_number(Findings& findings, const YamlNode& node, std::string_view label,
                                  const Range& range) {
  const std::optional<double> value = plain_number(node);
  if (value && range.contains(*value)) return value;
  expected(findings, node, label, "a number " + range.text());
  return std::nullopt;
}

std::optional<double> read_seconds(Findings& findings, const YamlNode& node, std::string_view label,
                                   const Range& range) {
  std::string_view unit;
  const auto number = number_with_unit(node, unit);
  const auto factor = number ? factor_in(time_units, unit) : std::nullopt;
  if (!factor) return read_number(findings, node, label, range);
  const double seconds = *number * *factor;
  if (range.contains(seconds)) return seconds;
  expected(findings, node, label, "a number " + range.text());
  return std::nullopt;
}

std::optional<std::int64_t> read_integer(Findings& findings, const YamlNode& node, std::string_view label,
                                         std::int64_t low, std::int64_t high) {
  if (node.kind == YamlNode::Kind::scalar && !node.quoted) {
    const auto value = number_in<std::int64_t>(node.text);
    if (value && *value >= low && *value <= high) return value;
  }
  expected(findings, node, label, fmt::format("a whole number from {} to {}", low, high));
  return std::nullopt;
}

std::optional<std::string> read_text(Findings& findings, const YamlNode& node, std::string_view label,
                                     std::string_view what) {
  if (node.kind == YamlNode::Kind::scalar) return node.text;
  expected(findings, node, label, what);
  return std::nullopt;
}

std::optional<std::string> read_name(Findings& findings, const YamlNode& node, std::string_view label) {
  constexpr std::size_t longest = 100;
  const bool fits = node.kind == YamlNode::Kind::scalar && !node.text.empty() && node.text.size() <= longest &&
                    std::ranges::none_of(node.text, [](char c) {
                      return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f ||
                             std::string_view("/*?[]").find(c) != std::string_view::npos;
                    });
  if (fits) return node.text;
  expected(findings, node, label,
           "a short name without blanks and none of / * ? [ ], because channels are named after it");
  return std::nullopt;
}

std::optional<bool> read_flag(Findings& findings, const YamlNode& node, std::string_view label) {
  if (node.kind == YamlNode::Kind::scalar && !node.quoted && (node.text == "true" || node.text == "false"))
    return node.text == "true";
  expected(findings, node, label, "true or false");
  return std::nullopt;
}

std::optional<double> read_rate(Findings& findings, const YamlNode& node, std::string_view label) {
  std::string_view unit;
  const auto rate = number_with_unit(node, unit);
  const auto factor = unit.empty() ? std::optional(1.0) : factor_in(rate_units, unit);
  if (rate && *rate > 0.0 && factor) return *rate * *factor;
  expected(findings, node, label, "a rate above 0 as 100 Hz");
  return std::nullopt;
}

std::optional<double> read_angle(Findings& findings, const YamlNode& node, std::string_view label) {
  if (const auto angle = number_or_angle(node); angle && any_angle.contains(angle->value)) {
    constexpr double turn = 2.0 * std::numbers::pi;
    if (!angle->angle && std::abs(angle->value) > turn)
      findings.warning(
          node,
          fmt::format("{} has no unit, so it is {} rad, {:.1f} turns", label, node.text, std::abs(angle->value) / turn),
          fmt::format("in degrees: {} deg; if radians are meant: {} rad", node.text, node.text));
    return angle->value;
  }
  expected(findings, node, label, "an angle: a number [rad], or with its unit as 10 deg or 0.1 rad");
  return std::nullopt;
}

std::optional<double> read_quantity(Findings& findings, const YamlNode& node, std::string_view label,
                                    std::span<const Spelling> units, const Range& range) {
  std::string_view unit;
  if (const auto number = number_with_unit(node, unit)) {
    const auto factor = unit.empty() ? std::optional(1.0) : factor_in(units, unit);
    if (factor && range.contains(*number * *factor)) return *number * *factor;
  }
  std::string with;
  for (const Spelling& each : units)
    with += fmt::format("{}{}", with.empty() ? ", or with its unit: " : ", ", each.text);
  expected(findings, node, label, "a number " + range.text() + with);
  return std::nullopt;
}

std::optional<Measure> read_measure(Findings& findings, const YamlNode& node, std::string_view label) {
  constexpr double largest = 1e12;
  const auto quantity = number_or_angle(node);
  if (quantity && std::abs(quantity->value) <= largest) return quantity;
  expected(findings, node, label, "a number in the unit of the series, or an angle as 10 deg or 0.1 rad");
  return std::nullopt;
}

std::optional<std::vector<double>> read_numbers(Findings& findings, const YamlNode& node, std::string_view label,
                                                std::size_t least, std::size_t most, const Range& range) {
  const std::string count = least == most ? fmt::format("{}", most) : fmt::format("{} or {}", least, most);
  if (node.kind != YamlNode::Kind::list) {
    expected(findings, node, label, fmt::format("a list of {} numbers", count));
    return std::nullopt;
  }
  if (node.items.size() < least || node.items.size() > most) {
    findings.error(node, fmt::format("{} has {} elements", label, node.items.size()),
                   fmt::format("expected {} numbers", count));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (const auto value = read_number(findings, *node.items[i], element(label, i), range)) values.push_back(*value);
  }
  if (values.size() != node.items.size()) return std::nullopt;
  return values;
}

std::optional<Eigen::Vector3d> read_vector3(Findings& findings, const YamlNode& node, std::string_view label,
                                            const Range& range) {
  const auto values = read_numbers(findings, node, label, 3, 3, range);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<Eigen::Quaterniond> read_rotation(Findings& findings, const YamlNode& node, std::string_view label) {
  if (node.kind == YamlNode::Kind::list && node.items.size() == 3) return roll_pitch_yaw(findings, node, label);
  if (node.kind != YamlNode::Kind::map) {
    findings.error(node,
                   node.kind == YamlNode::Kind::list ? fmt::format("{} has {} elements", label, node.items.size())
                                                     : fmt::format("{} is {}", label, describe(node)),
                   "expected [roll, pitch, yaw], {axis: [x, y, z], angle: A} or {quaternion: [w, x, y, z]}");
    return std::nullopt;
  }
  const Keys keys(findings, node, rotation_form());
  if (const YamlNode* quaternion = keys.find("quaternion")) {
    if (keys.find("axis") != nullptr || keys.find("angle") != nullptr)
      findings.error(node, "the rotation is given twice", "either quaternion, or axis and angle");
    return unit_quaternion(findings, *quaternion);
  }
  const YamlNode* axis = keys.require("axis", "[x, y, z], or quaternion: [w, x, y, z] instead");
  const YamlNode* angle = keys.require("angle", "a number [rad], or with its unit as 10 deg or 0.1 rad");
  if (axis == nullptr || angle == nullptr) return std::nullopt;
  return axis_and_angle(findings, *axis, *angle);
}

std::span<const YamlNodePtr> read_list(Findings& findings, const YamlNode& node, std::string_view label,
                                       std::string_view what) {
  // Far more than any scenario needs; it stops files that would take minutes to read.
  constexpr std::size_t longest = 1000;
  if (node.kind == YamlNode::Kind::list && node.items.size() <= longest) return node.items;
  if (node.kind == YamlNode::Kind::list) {
    findings.error(node, fmt::format("{} has {} elements", label, node.items.size()),
                   fmt::format("expected at most {}", longest));
  } else {
    expected(findings, node, label, what);
  }
  return {};
}

std::vector<NamedEntry> read_entries(Findings& findings, const YamlNode& map) {
  std::vector<NamedEntry> entries;
  std::map<std::string_view, int> first_line;
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    const YamlNode& key = *map.keys[i];
    if (key.kind != YamlNode::Kind::scalar) {
      findings.error(key, fmt::format("a key is {}", describe(key)), "expected a word");
      continue;
    }
    const auto [place, is_new] = first_line.emplace(key.text, key.line);
    if (is_new) {
      entries.push_back({key.text, &key, map.items[i].get()});
    } else {
      findings.error(key, fmt::format("'{}' is given twice", shortened(key.text)),
                     fmt::format("it is already in line {}", place->second));
    }
  }
  return entries;
}

const YamlNode* find_key(const YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i]->kind == YamlNode::Kind::scalar && map.keys[i]->text == key) return map.items[i].get();
  }
  return nullptr;
}

Written written(double value) { return {fmt::format("{}", value)}; }
Written written(float value) { return {fmt::format("{}", value)}; }
Written written(int value) { return {fmt::format("{}", value)}; }
Written written(std::uint32_t value) { return {fmt::format("{}", value)}; }
Written written(bool value) { return {value ? "true" : "false"}; }
Written written(const std::string& value) { return value.empty() ? Written() : Written{value}; }
Written written(const Eigen::Vector3d& value) {
  return {fmt::format("{}", value.x()), fmt::format("{}", value.y()), fmt::format("{}", value.z())};
}
Written written(const Eigen::Vector3f& value) {
  return {fmt::format("{}", value.x()), fmt::format("{}", value.y()), fmt::format("{}", value.z())};
}

std::string one_text(const Written& elements) {
  if (elements.size() < 2) return elements.empty() ? "" : elements[0];
  return fmt::format("[{}]", fmt::join(elements, ", "));
}

Keys::Keys(Findings& findings, const YamlNode& node, const Form& form) : findings_(findings), node_(node), form_(form) {
  if (!is_map()) {
    findings_.error(node, fmt::format("{} is {}", form.owner, describe(node)), "expected a map of KEY: VALUE");
    return;
  }
  entries_ = read_entries(findings_, node);
  const std::vector<std::string_view> keys = form.key_names();
  const std::vector<std::string> names(keys.begin(), keys.end());
  for (const NamedEntry& entry : entries_) {
    if (form.find(entry.name) != nullptr) continue;
    has_unknown_ = true;
    const std::vector<std::string> near = near_names(entry.name, names);
    findings_.error(*entry.key, fmt::format("unknown key '{}' in {}", shortened(entry.name), form.owner),
                    near_hint(with_described(near, form, entry.name), names, "keys"));
    misspelt_.insert(misspelt_.end(), near.begin(), near.end());
  }
}

const YamlNode* Keys::find(std::string_view key) const {
  return form_.find(key) != nullptr ? find_key(node_, key) : nullptr;
}

const FormKey& Keys::row(std::string_view key) const {
  const FormKey* row = form_.find(key);
  REHEARSE_ASSERT(row != nullptr, "a key that is read is in the form");
  return *row;
}

const Range& Keys::range_of(std::string_view key) const {
  const ValueType& type = row(key).type;
  return type.kind == ValueType::Kind::list ? type.parts[0].range : type.range;
}

void Keys::set_default(std::string_view key, std::vector<std::string> elements) const {
  const std::string_view stated = row(key).fallback;
  REHEARSE_ASSERT(stated.empty() || stated == required || stated == one_text(elements),
                  "the default is that of the form");
  findings_.set_default(node_, key, std::move(elements));
}

const YamlNode* Keys::require(std::string_view key, std::string_view what) const {
  const YamlNode* value = find(key);
  const bool told = std::ranges::find(misspelt_, key) != misspelt_.end();
  if (value == nullptr && is_map() && !told)
    findings_.error(node_, fmt::format("{} has no '{}'", form_.owner, key), fmt::format("expected {}: {}", key, what));
  return value;
}

std::optional<double> Keys::number(std::string_view key, const YamlNode& node) const {
  const ValueType& type = row(key).type;
  return type.kind == ValueType::Kind::quantity ? read_quantity(findings_, node, key, type.units, type.range)
                                                : read_number(findings_, node, key, type.range);
}

std::optional<std::int64_t> Keys::whole(std::string_view key, const YamlNode& node) const {
  const Range& range = range_of(key);
  return read_integer(findings_, node, key, static_cast<std::int64_t>(range.low),
                      static_cast<std::int64_t>(range.high));
}

template <class Value, class Read>
void Keys::take(std::string_view key, Value& out, Read&& read_stated) const {
  if (const YamlNode* node = find(key)) {
    if (const auto value = read_stated(*node)) out = static_cast<Value>(*value);
  } else if (Written elements = written_default(row(key).type, out); !elements.empty()) {
    set_default(key, std::move(elements));
  }
}

void Keys::read(std::string_view key, double& out) const {
  take(key, out, [&](const YamlNode& node) { return number(key, node); });
}

void Keys::read(std::string_view key, float& out) const {
  take(key, out, [&](const YamlNode& node) { return number(key, node); });
}

void Keys::read(std::string_view key, std::optional<double>& out) const {
  take(key, out, [&](const YamlNode& node) { return number(key, node); });
}

void Keys::read(std::string_view key, int& out) const {
  take(key, out, [&](const YamlNode& node) { return whole(key, node); });
}

void Keys::read(std::string_view key, std::uint32_t& out) const {
  take(key, out, [&](const YamlNode& node) { return whole(key, node); });
}

void Keys::read(std::string_view key, std::optional<int>& out) const {
  take(key, out, [&](const YamlNode& node) { return whole(key, node); });
}

void Keys::read(std::string_view key, std::string& out) const {
  take(key, out, [&](const YamlNode& node) { return read_text(findings_, node, key); });
}

void Keys::read(std::string_view key, bool& out) const {
  take(key, out, [&](const YamlNode& node) { return read_flag(findings_, node, key); });
}

void Keys::read(std::string_view key, std::optional<bool>& out) const {
  take(key, out, [&](const YamlNode& node) { return read_flag(findings_, node, key); });
}

void Keys::read(std::string_view key, Eigen::Vector3d& out) const {
  take(key, out, [&](const YamlNode& node) { return read_vector3(findings_, node, key, range_of(key)); });
}

void Keys::read(std::string_view key, Eigen::Vector3f& out) const {
  take(key, out, [&](const YamlNode& node) -> std::optional<Eigen::Vector3f> {
    const auto read = read_vector3(findings_, node, key, range_of(key));
    return read ? std::optional<Eigen::Vector3f>(read->cast<float>()) : std::nullopt;
  });
}

}  // namespace rehearse
