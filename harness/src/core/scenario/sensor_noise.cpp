#include <rehearse/scenario.h>

#include <algorithm>

namespace rehearse {

const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities{
    {{"displacement", "rad or m", 1}, {"velocity", "rad/s or m/s", 1}, {"effort", "N·m or N", 1}}};

bool DeviceNoise::changes_nothing() const {
  return dropout == 0.0 &&
         std::all_of(quantities.begin(), quantities.end(), [](const Noise& noise) { return noise.changes_nothing(); });
}

bool JointNoise::changes_nothing() const {
  return std::all_of(quantities.begin(), quantities.end(), [](const Noise& noise) { return noise.changes_nothing(); });
}

bool BodyNoise::disturbs_joints() const {
  return std::any_of(joints.begin(), joints.end(), [](const JointNoise& noise) { return !noise.changes_nothing(); });
}

}  // namespace rehearse
