// MuJoCo's models (MJCF): loads a file whose root element is <mujoco> into a Model, and reads the drives of its joints.
//
// A value comes from the element, else from its class, else from the class that contains that class. Defaults are those
// of MuJoCo's XML reference of version 3; angles are in degrees unless the file says radian.
//
// - One body in <worldbody> is the root: free with a <freejoint>, else fixed. If it has hinges or slides, or if there
//   are several bodies, the root is a link 'world', which is fixed and has the geoms of <worldbody>.
// - A link's frame is its body's frame, moved to the anchor of the body's last joint. A body with several joints gets a
//   link for each but the last, named BODY_JOINT, with a billionth of its mass.
// - With ref, the displacement of a joint is ref where MuJoCo's file describes the model.
// - Geoms with contype and conaffinity 0 are visible shapes only; those of groups 3 to 5 are collision shapes only.
//   Masks and <exclude> decide which links of the body touch each other.
// - What has no counterpart is an error, or, with UrdfOptions::allow_unsupported, left out with a note.
// - Model::source_text has the included files, and of each mesh the volume and the inertia, for a replay.
#pragma once

#include <rehearse/model.h>
#include <rehearse/urdf.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// True if the text's first element is <mujoco>.
bool is_mjcf(std::string_view text);

/// Reads and checks a text in memory: the text of a file, or a Model::source_text. `name` replaces the file's name in
/// messages, in Model::source_file, and as the file that paths are relative to. On failure: the errors of the file and
/// of the files that it includes, each with its place.
Result<Model> parse_mjcf(const std::string& text, const std::string& name, const UrdfOptions& options = {});

/// The drive of a joint. A value is nullopt if the model states none, or MuJoCo's default of 0. Efforts and gains of an
/// actuator act behind its gear g: forces are multiplied with |g|, gains with g².
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

/// The drives of the model's hinges and slides, in document order, read as by parse_mjcf() with allow_unsupported and
/// without meshes; masses aren't checked.
Result<std::vector<MjcfDrive>> load_mjcf_drives(const std::filesystem::path& file);

}  // namespace rehearse
