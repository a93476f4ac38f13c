#include <rehearse/sensor_errors.h>

#include "sensor_error.h"

#include <algorithm>

namespace rehearse {

std::span<const ErrorForm* const> error_forms() {
  static constexpr const ErrorForm* all[] = {
#define REHEARSE_ERROR(name) &name##_error,
#include "sensor_errors.inl"
#undef REHEARSE_ERROR
  };
  return all;
}

const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities{
    {{"displacement", "rad or m", 1}, {"velocity", "rad/s or m/s", 1}, {"effort", "N·m or N", 1}}};

Eigen::Vector3d QuantityErrors::of(std::string_view key) const {
  for (const GivenError& each : given)
    if (each.form->key == key) return {each.numbers[0], each.numbers[1], each.numbers[2]};
  return Eigen::Vector3d::Zero();
}

bool ReadingErrors::is_timed() const {
  return rate > 0.0 || latency > 0.0 || burst > 0.0 || !stuck.empty() || !lost.empty() || !delayed.empty();
}

bool ReadingErrors::changes_nothing() const {
  return dropout == 0.0 && !is_timed() &&
         std::ranges::all_of(quantities, [](const auto& each) { return each.changes_nothing(); });
}

bool ReadingErrors::records_truth() const {
  return is_timed() || std::ranges::any_of(quantities, [](const QuantityErrors& of_one) {
           return std::ranges::any_of(of_one.given, [](const GivenError& each) { return each.form->records_truth; });
         });
}

bool BodyErrors::disturbs_joints() const {
  return std::ranges::any_of(joints, [](const ReadingErrors& each) { return !each.changes_nothing(); });
}

}  // namespace rehearse
