#include "sensor_error.h"

namespace rehearse {

std::span<const Spelling> units_of_error(ErrorUnit unit, const MeasuredQuantity& quantity, bool linear) {
  const UnitName of_quantity = linear ? quantity.linear_unit : quantity.unit;
  switch (unit) {
    case ErrorUnit::quantity: return of_quantity.empty() ? std::span<const Spelling>() : of_quantity.spellings();
    case ErrorUnit::per_root_hertz: return density_spellings(of_quantity, DensityPer::root_hertz);
    case ErrorUnit::per_root_second: return density_spellings(of_quantity, DensityPer::root_second);
    case ErrorUnit::share: return UnitName("").spellings();
    case ErrorUnit::angle: return angle_units;
    case ErrorUnit::per_turn:
    case ErrorUnit::none: break;
  }
  return {};
}

}  // namespace rehearse
