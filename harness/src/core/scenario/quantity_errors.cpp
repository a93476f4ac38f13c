// The errors of a quantity in a scenario.
#include <rehearse/sensor_errors.h>

#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "sensor_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

/// An error whose span of time belongs to it.
std::optional<GivenError> read_timed(Findings& findings, const YamlNode& node, const ErrorForm& form,
                                     const MeasuredQuantity& quantity, bool slides) {
  const Keys keys(findings, node, timed_error_form(quantity));
  if (!keys.is_map()) return std::nullopt;
  const YamlNode* by = keys.require("by", "the change of the readings, in the unit of the quantity");
  const auto numbers = by ? read_error_numbers(findings, *by, form, quantity, slides) : std::nullopt;
  if (!numbers) return std::nullopt;
  return GivenError{&form, *numbers, read_spell_keys(findings, keys)};
}

const BoundForm<Spell>& bound_spell_form() {
  static const BoundForm<Spell> form{
      "spell",
      "stuck",
      {{"from", &Spell::from, types::quantity(time_units, any_time), "when it begins [s]"},
       {"until", &Spell::until, types::quantity(time_units, any_time), "when it ends [s]; default: never"}}};
  return form;
}

}  // namespace

const Form& spell_form() { return bound_spell_form(); }

Spell read_spell_keys(Findings& findings, const Keys& keys) {
  Spell spell;
  bound_spell_form().read(keys, spell);
  if (spell.until <= spell.from)
    findings.error(*keys.find("until"), fmt::format("until is {}, which is not after from", spell.until),
                   fmt::format("expected a time above {} [s]", spell.from));
  return spell;
}

std::optional<Spell> read_stuck(Findings& findings, const YamlNode& node) {
  const Keys keys(findings, node, spell_form());
  if (!keys.is_map()) return std::nullopt;
  return read_spell_keys(findings, keys);
}

std::optional<std::array<double, 3>> read_error_numbers(Findings& findings, const YamlNode& node, const ErrorForm& form,
                                                        const MeasuredQuantity& quantity, bool slides) {
  std::array<double, 3> numbers{};
  if (node.kind == YamlNode::Kind::list && quantity.axes == 3) {
    const auto each = read_vector3(findings, node, form.key, form.range);
    if (!each) return std::nullopt;
    numbers = {each->x(), each->y(), each->z()};
    return numbers;
  }
  const std::span<const Spelling> units = units_of_error(form.unit, quantity, slides);
  const auto all = units.empty() ? read_number(findings, node, form.key, form.range)
                                 : read_quantity(findings, node, form.key, units, form.range);
  if (!all) return std::nullopt;
  const bool is_of_turn = form.unit == ErrorUnit::per_turn && !slides;
  numbers.fill(is_of_turn ? *all / (2.0 * std::numbers::pi) : *all);
  return numbers;
}

std::optional<QuantityErrors> read_quantity_errors(Findings& findings, const YamlNode& node,
                                                   const MeasuredQuantity& quantity, bool slides) {
  const Keys keys(findings, node, errors_form(quantity));
  if (!keys.is_map() || keys.has_unknown()) return std::nullopt;
  QuantityErrors errors;
  bool is_right = true;
  for (const ErrorForm* form : error_forms()) {
    const YamlNode* value = keys.find(form->key);
    if (!value) continue;
    if (form->is_timed) {
      const auto timed = read_timed(findings, *value, *form, quantity, slides);
      is_right = is_right && timed;
      if (timed) errors.given.push_back(*timed);
      continue;
    }
    const auto numbers = read_error_numbers(findings, *value, *form, quantity, slides);
    is_right = is_right && numbers;
    const bool is_neutral =
        numbers && (*numbers)[0] == form->neutral && (*numbers)[1] == form->neutral && (*numbers)[2] == form->neutral;
    if (numbers && !is_neutral) errors.given.push_back({form, *numbers, {}});
  }
  if (keys.entries().empty())
    findings.error(node, fmt::format("the noise of {} states no error", quantity.name),
                   fmt::format("expected one or more of {}", fmt::join(errors_form(quantity).key_names(), ", ")));
  return is_right ? std::optional(std::move(errors)) : std::nullopt;
}

}  // namespace rehearse
