// The keys of errors and faults.
#include <rehearse/model.h>
#include <rehearse/sensor_errors.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "sensor_error.h"

namespace rehearse {
namespace {

/// The numbers of an error: one, or one for each axis.
ValueType error_numbers(const ErrorForm& form, const MeasuredQuantity& quantity_of) {
  std::vector<ValueType> forms_of_number{types::number(form.range)};
  for (const bool slides : {false, true})
    if (const auto units = units_of_error(form.unit, quantity_of, slides); !units.empty())
      forms_of_number.push_back(types::quantity(units, form.range));
  if (quantity_of.axes == 3) forms_of_number.push_back(types::vector3(form.range));
  return types::either(std::move(forms_of_number));
}

/// Whether the quantity can have the error.
bool is_possible(const ErrorForm& form, const MeasuredQuantity& quantity_of) {
  switch (form.of) {
    case ErrorOf::any: return true;
    case ErrorOf::with_axes: return quantity_of.axes == 3;
    case ErrorOf::displacement: return quantity_of.name == joint_quantities[0].name;
    case ErrorOf::color: return quantity_of.name == "color";
  }
  return false;
}

/// The forms of quantities by quantity, each made once. Names are kept, because a form refers to its name.
struct FormOfQuantity {
  std::string name;
  Form form;
};
using QuantityKey = std::pair<std::string, int>;  // name and axes

Form make_errors_form(const MeasuredQuantity& quantity_of, std::string_view name) {
  Form form{name, "the noise of a quantity", {}};
  for (const ErrorForm* each : error_forms()) {
    if (!is_possible(*each, quantity_of)) continue;
    const ValueType type = each->is_timed
                               ? types::of([quantity_of]() -> const Form& { return timed_error_form(quantity_of); })
                               : error_numbers(*each, quantity_of);
    form.keys.push_back({each->key, type, each->text});
  }
  return form;
}

Form make_timed_form(const MeasuredQuantity& quantity_of, std::string_view name) {
  const auto all = error_forms();
  const auto timed = std::ranges::find_if(all, [](const ErrorForm* each) { return each->is_timed; });
  return {name,
          "an offset",
          {{"by", error_numbers(**timed, quantity_of), "the change of the readings", required},
           *spell_form().find("from"),
           *spell_form().find("until")}};
}

const Form& form_of_quantity(const MeasuredQuantity& quantity_of, const char* prefix,
                             std::map<QuantityKey, FormOfQuantity>& made,
                             Form (*make)(const MeasuredQuantity&, std::string_view)) {
  const QuantityKey key(quantity_of.name, quantity_of.axes);
  const auto found = made.find(key);
  if (found != made.end()) return found->second.form;
  FormOfQuantity& one = made[key];
  one.name = prefix + key.first;
  one.form = make(quantity_of, one.name);
  return one.form;
}

}  // namespace

const std::vector<MeasuredQuantity>& measured_quantities() {
  static const std::vector<MeasuredQuantity> quantities = [] {
    std::vector<MeasuredQuantity> all;
    const auto add = [&](const MeasuredQuantity& quantity) {
      if (std::ranges::none_of(all, [&](const auto& each) { return each.name == quantity.name; }))
        all.push_back(quantity);
    };
    for (const DeviceKind& kind : device_kinds()) {
      Device device;
      device.kind = kind;
      for (const MeasuredQuantity& quantity : quantities_of(device)) add(quantity);
    }
    for (const MeasuredQuantity& quantity : joint_quantities) add(quantity);
    return all;
  }();
  return quantities;
}

const Form& errors_form(const MeasuredQuantity& quantity) {
  static std::map<QuantityKey, FormOfQuantity> made;
  return form_of_quantity(quantity, "errors_of_", made, make_errors_form);
}

const Form& timed_error_form(const MeasuredQuantity& quantity) {
  static std::map<QuantityKey, FormOfQuantity> made;
  return form_of_quantity(quantity, "offset_of_", made, make_timed_form);
}

const Form& data_sheet_form() {
  const auto one = [](std::string_view name, UnitName unit, const ErrorForm& error) {
    return FormKey{name, error_numbers(error, {"", unit, 1}), "of the data sheet", required};
  };
  static const Form form{
      "data_sheet",
      "the data sheet of an IMU",
      {one("gyroscope_noise_density", "rad/s", density_error),
       one("gyroscope_random_walk", "rad/s", bias_walk_error),
       one("accelerometer_noise_density", "m/s²", density_error),
       one("accelerometer_random_walk", "m/s²", bias_walk_error),
       {"update_rate", types::quantity(rate_units, any_reading_rate), "of readings [Hz]", required}}};
  return form;
}

}  // namespace rehearse
