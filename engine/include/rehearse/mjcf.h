// The drives of a MuJoCo model (MJCF): what its joints and actuators state of damping, friction, rotors, limits and
// gains. Nothing else of the model is read.
//
// The meanings are those of MuJoCo's XML reference: a value comes from the element, else from its class, else from the
// class that contains that class. Efforts and gains of an actuator act behind its gear g: forces are multiplied with
// |g|, gains with g². Files that the model includes are read too.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The drive of a joint. A value is nullopt if the model states none, or MuJoCo's default of 0.
struct MjcfDrive {
  std::string joint;
  std::optional<double> effort;         // largest, of all that the model states [N·m] or [N]
  std::optional<double> damping;        // [N·m·s/rad] or [N·s/m]
  std::optional<double> coulomb;        // frictionloss [N·m] or [N]
  std::optional<double> armature;       // [kg·m²] or [kg]
  std::optional<double> position_gain;  // [N·m/rad] or [N/m]
  std::optional<double> velocity_gain;  // [N·m·s/rad] or [N·s/m]

  bool states_anything() const { return effort || damping || coulomb || armature || position_gain || velocity_gain; }
};

/// The hinges and slides of the model, in document order. Fails for a file that is no MuJoCo model, and lists all
/// values that are no numbers, and actuators of joints that the model lacks.
Result<std::vector<MjcfDrive>> load_mjcf_drives(const std::filesystem::path& file);

}  // namespace rehearse
